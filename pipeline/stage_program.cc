// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage_program.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "pipeline/file_state.h"
#include "pipeline/subprocess.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

std::vector<OptionInfo> OptionsFromLines(std::istream& lines) {
  std::vector<OptionInfo> options;
  for (std::string line; std::getline(lines, line);) options.push_back(OptionFromLine(line));
  return options;
}

// Cache file: state of the executable, its digest, then the lines of --list-options.
bool ReadCache(const fs::path& cache, const std::string& state, StageProgram* program) {
  std::error_code error;
  if (!fs::exists(cache, error)) return false;
  std::istringstream text(formats::ReadWholeFile(cache));
  std::string cached_state;
  std::getline(text, cached_state);
  if (cached_state != state || !std::getline(text, program->identity)) return false;
  program->options = OptionsFromLines(text);
  return true;
}

// What the build wrote down beside the graph, unless the executable is newer.
std::optional<std::string> AnswerFromTheBuild(const std::string& stage, const fs::path& executable) {
  const fs::path answer = executable.parent_path().parent_path() / "share" / "plumbline" / "options" / stage;
  std::error_code error;
  const fs::file_time_type written = fs::last_write_time(answer, error);
  if (error || written < fs::last_write_time(executable)) return std::nullopt;
  return formats::ReadWholeFile(answer);
}

std::string Ask(const std::string& stage, const fs::path& executable) {
  if (std::optional<std::string> answer = AnswerFromTheBuild(stage, executable)) return *std::move(answer);
  const ProgramOutput answer = RunAndRead({executable.string(), "--list-options"});
  if (answer.status != 0) throw DataError(executable.string() + " --list-options: failed");
  return answer.out;
}

}  // namespace

std::string ToLine(const OptionInfo& option) {
  std::string allowed;
  for (const std::string& word : option.allowed) allowed += (allowed.empty() ? "" : ",") + word;
  return option.key + "\t" + option.type + "\t" + option.default_text + "\t" + option.min + "\t" + option.max + "\t" +
         allowed + "\t" + option.help;
}

OptionInfo OptionFromLine(const std::string& line) {
  const std::vector<std::string> fields = Split(line, '\t');
  if (fields.size() != 7) throw std::invalid_argument("not a line of --list-options: " + line);
  OptionInfo option{fields[0], fields[1], fields[2], fields[3], fields[4], {}, fields[6]};
  if (!fields[5].empty()) option.allowed = Split(fields[5], ',');
  return option;
}

const OptionInfo* StageProgram::Find(const std::string& key) const {
  const auto found =
      std::find_if(options.begin(), options.end(), [&](const auto& option) { return option.key == key; });
  return found == options.end() ? nullptr : &*found;
}

StageProgram AskStageProgram(const std::string& stage, const fs::path& bin_folder, const fs::path& cache_folder) {
  const fs::path executable = bin_folder / ("plumbline-" + stage);
  std::error_code error;
  if (!fs::exists(executable, error)) throw DataError(executable.string() + ": no such program; is Plumbline whole?");
  StageProgram program{.stage = stage, .identity = "", .options = {}};
  const std::string state = FileState(executable);
  const fs::path cache = cache_folder / stage;
  if (!cache_folder.empty() && ReadCache(cache, state, &program)) return program;

  const std::string answer = Ask(stage, executable);
  std::istringstream lines(answer);
  program.options = OptionsFromLines(lines);
  program.identity = formats::Sha256OfFile(executable);
  if (!cache_folder.empty()) {
    formats::WriteFileAtomically(cache, state + "\n" + program.identity + "\n" + answer);
  }
  return program;
}

std::vector<std::string> InstalledStages(const fs::path& bin_folder) {
  static const std::string kPrefix = "plumbline-";
  std::vector<std::string> stages;
  for (const fs::directory_entry& entry : fs::directory_iterator(bin_folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kPrefix)) stages.push_back(name.substr(kPrefix.size()));
  }
  std::sort(stages.begin(), stages.end());
  return stages;
}

}  // namespace pipeline
