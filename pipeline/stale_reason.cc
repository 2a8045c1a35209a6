// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stale_reason.h"

#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "formats/atomic_file.h"
#include "pipeline/words.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostInputs = 4;  // named in one line

fs::path StampOf(const fs::path& site, const StageRunInfo& run) { return site / "work" / ".stamps" / run.name; }

// "work/.sources/control/points.csv" is control/points.csv to people.
std::string NameForPeople(const std::string& input) {
  static const std::string kSources = "work/.sources/";
  return input.starts_with(kSources) ? input.substr(kSources.size()) : input;
}

bool IsSlice(const std::string& input) { return input.starts_with("work/") && input.ends_with(".toml"); }

// "now with a b, no longer with c": how the command differs from the one that last succeeded.
std::string CommandChange(const std::string& before, const std::string& now) {
  const std::vector<std::string> words_before = Words(before);
  const std::vector<std::string> words_now = Words(now);
  const auto missing_in = [](const std::vector<std::string>& words, const std::vector<std::string>& others) {
    const std::set<std::string> known(others.begin(), others.end());
    std::string text;
    for (const std::string& word : words) {
      if (!known.contains(word)) text += " " + word;
    }
    return text;
  };
  const std::string added = missing_in(words_now, words_before);
  const std::string removed = missing_in(words_before, words_now);
  if (added.empty() && removed.empty()) return "its inputs come in another order";
  return (added.empty() ? "" : "now with" + added) + (added.empty() || removed.empty() ? "" : ", ") +
         (removed.empty() ? "" : "no longer with" + removed);
}

struct Slice {
  std::string build;  // "plumbline-grid 5f3c..."
  std::map<std::string, std::string> values;
};

Slice SliceFromText(const std::string& text) {
  Slice slice;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    if (line.starts_with("# plumbline-")) {
      slice.build = line.substr(2);
    } else if (!line.starts_with("#") && equals != std::string::npos) {
      slice.values[line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return slice;
}

void Append(const std::string& reason, std::string* reasons) { *reasons += (reasons->empty() ? "" : "; ") + reason; }

std::string SliceReason(const fs::path& site, const StageRunInfo& run, const std::string& slice) {
  const fs::path before = StampOf(site, run).string() + ".toml";
  const std::string change =
      fs::exists(before) ? SliceChange(formats::ReadWholeFile(before), formats::ReadWholeFile(site / slice)) : "";
  return change.empty() ? "its options or the program changed (" + slice + ")" : change;
}

// Inputs that are newer than the stamp.
std::string InputReasons(const fs::path& site, const StageRunInfo& run) {
  std::string reasons;
  std::vector<std::string> changed;
  for (const std::string& input : run.inputs) {
    if (!fs::exists(site / input)) {
      Append(NameForPeople(input) + " is not there yet", &reasons);
    } else if (fs::last_write_time(site / input) > fs::last_write_time(StampOf(site, run))) {
      if (IsSlice(input)) {
        Append(SliceReason(site, run, input), &reasons);
      } else {
        changed.push_back(NameForPeople(input));
      }
    }
  }
  if (changed.empty()) return reasons;
  std::string names;
  for (std::size_t i = 0; i < std::min(changed.size(), kMostInputs); ++i) names += (i > 0 ? ", " : "") + changed[i];
  if (changed.size() > kMostInputs) names += " and " + std::to_string(changed.size() - kMostInputs) + " more";
  Append(names + " changed", &reasons);
  return reasons;
}

}  // namespace

std::string SliceChange(const std::string& before, const std::string& now) {
  const Slice old_slice = SliceFromText(before);
  const Slice new_slice = SliceFromText(now);
  std::string text;
  if (old_slice.build != new_slice.build) {
    Append(new_slice.build.substr(0, new_slice.build.find(' ')) + " is another build", &text);
  }
  for (const auto& [key, value] : new_slice.values) {
    const auto old_value = old_slice.values.find(key);
    if (old_value == old_slice.values.end()) {
      Append("option " + key + ": " + value + ", was not given", &text);
    } else if (old_value->second != value) {
      Append("option " + key + ": " + value + ", was " + old_value->second, &text);
    }
  }
  for (const auto& [key, value] : old_slice.values) {
    if (!new_slice.values.contains(key)) Append("option " + key + ": no longer given, was " + value, &text);
  }
  return text;
}

std::optional<std::string> WhyStale(const fs::path& site, const StageRunInfo& run) {
  const fs::path stamp = StampOf(site, run);
  if (!fs::exists(stamp)) return "never finished";
  std::string reasons;
  for (const std::string& output : run.outputs) {
    if (!fs::exists(site / output)) Append(output + " is missing", &reasons);
  }
  const std::string text = formats::ReadWholeFile(stamp);
  const std::string done = text.substr(0, text.find_last_not_of('\n') + 1);
  if (done != run.command) Append(CommandChange(done, run.command), &reasons);
  const std::string inputs = InputReasons(site, run);
  if (!inputs.empty()) Append(inputs, &reasons);
  if (reasons.empty()) return std::nullopt;
  return reasons;
}

}  // namespace pipeline
