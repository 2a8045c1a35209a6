// SPDX-License-Identifier: Apache-2.0
//
// A whole site with two small blocks, made and processed by the real executables.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace test_support {

// Simulated once per test program: blocks/A, blocks/B, control/points.csv.
const std::filesystem::path& FieldDataOfTwoRooms();

// Replaces the only occurrence of `from`.
void ReplaceInFile(const std::filesystem::path& file, const std::string& from, const std::string& to);
void AppendToFile(const std::filesystem::path& file, const std::string& text);

// Files of which the two results hold different bytes, or only one has them.
std::vector<std::string> Differences(const std::map<std::string, std::string>& a,
                                     const std::map<std::string, std::string>& b);

class JobSite {
 public:
  // A new site in `folder`, or in a scratch folder.
  explicit JobSite(std::filesystem::path folder = {});
  // A copy of a site that has been brought up to date once per test program.
  static JobSite Processed();

  const std::filesystem::path& path() const { return site_; }
  std::filesystem::path operator/(const std::string& name) const { return site_ / name; }

  CommandResult Run(std::vector<std::string> arguments = {}) const;

  // The stages that a run executed ("A track", "network"), sorted. A run that fails adds "failed: " and its messages.
  std::vector<std::string> StagesOfRun(std::vector<std::string> arguments = {}) const;

  // Starts a run and kills it with all its processes after `delay`; false when it had ended by then.
  bool RunAndKillAfter(std::chrono::milliseconds delay) const;

  // Digests of all results by relative path: everything in out/, the artefacts in work/.
  std::map<std::string, std::string> Results() const;

 private:
  struct CopyOf {
    const JobSite& original;
  };
  explicit JobSite(CopyOf copy);

  ScratchFolder scratch_;
  std::filesystem::path site_;
};

}  // namespace test_support
