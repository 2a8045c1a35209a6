// SPDX-License-Identifier: Apache-2.0
//
// What the rest of the system knows about a stage's executable: the options it declares and which build it is. Learned
// by running `plumbline-STAGE --list-options`, once per build.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pipeline {

// A line of --list-options: key, type, default, smallest, largest and allowed values, help, separated by tabs.
struct OptionInfo {
  std::string key;
  std::string type;  // number, integer, boolean, string
  std::string default_text;
  std::string min;  // empty: no bound
  std::string max;
  std::vector<std::string> allowed;  // empty: any text
  std::string help;

  bool operator==(const OptionInfo&) const = default;
};

std::string ToLine(const OptionInfo& option);
OptionInfo OptionFromLine(const std::string& line);  // std::invalid_argument when it is no such line

struct StageProgram {
  std::string stage;
  std::string identity;  // SHA-256 of the executable: a rebuilt program counts as changed only if its bytes did
  std::vector<OptionInfo> options;

  const OptionInfo* Find(const std::string& key) const;  // null when the stage has no such option
};

// Asks bin_folder/plumbline-STAGE, or takes the answer kept in cache_folder if the executable still has the same size
// and time, or the one that the build wrote to ../share/plumbline/options. DataError when the program is missing. An
// empty cache_folder: always ask.
StageProgram AskStageProgram(const std::string& stage, const std::filesystem::path& bin_folder,
                             const std::filesystem::path& cache_folder);

// All stages installed beside us, by name.
std::vector<std::string> InstalledStages(const std::filesystem::path& bin_folder);

}  // namespace pipeline
