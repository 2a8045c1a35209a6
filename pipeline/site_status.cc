// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_status.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "pipeline/site_lock.h"
#include "pipeline/stale_reason.h"
#include "pipeline/subprocess.h"
#include "pipeline/words.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

StageRunInfo RunFromLine(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, '|');) fields.push_back(field);
  if (fields.size() != 6) throw formats::DataError("make graph: cannot be understood: " + line);
  return {fields[0], fields[1], fields[2], Words(fields[3]), Words(fields[4]), fields[5]};
}

// True when the log tells of an attempt later than the last success.
bool LogIsNewer(const fs::path& site, const StageRunInfo& run) {
  const fs::path log = site / "logs" / (run.name + ".log");
  const fs::path stamp = site / "work" / ".stamps" / run.name;
  if (!fs::exists(log)) return false;
  return !fs::exists(stamp) || fs::last_write_time(log) > fs::last_write_time(stamp);
}

const char* Word(RunState state) {
  switch (state) {
    case RunState::kDone:
      return "done";
    case RunState::kStale:
      return "stale";
    case RunState::kWaiting:
      return "waiting";
    case RunState::kFailed:
      return "failed";
    case RunState::kRunning:
      return "running";
  }
  return "";
}

// What `plumbline run` would do: runs that are stale by themselves, and those that follow unless nothing comes out
// anew.
std::string NextRun(const std::vector<RunStatus>& statuses) {
  std::string sure;
  std::string perhaps;
  for (const RunStatus& status : statuses) {
    if (status.state == RunState::kDone || status.state == RunState::kRunning) continue;
    std::string& list = status.state == RunState::kWaiting ? perhaps : sure;
    list += (list.empty() ? "" : ", ") + status.run.Title();
  }
  if (!sure.empty()) sure = "a run does: " + sure + "\n";
  if (!perhaps.empty()) perhaps = "and where that brings new results: " + perhaps + "\n";
  return sure + perhaps;
}

}  // namespace

std::vector<StageRunInfo> ReadGraph(const fs::path& site) {
  const ProgramOutput listing = RunAndRead({"make", "--no-print-directory", "-s", "-C", site.string(), "graph"});
  if (listing.status != 0) throw formats::DataError(site.string() + ": the site is not ready");
  std::vector<StageRunInfo> graph;
  std::istringstream lines(listing.out);
  for (std::string line; std::getline(lines, line);) graph.push_back(RunFromLine(line));
  return graph;
}

LogEnd ReadLogEnd(const fs::path& log) {
  if (!fs::exists(log)) return {};
  const std::string text = formats::ReadWholeFile(log);
  const std::size_t failed = text.rfind("\nfailed (");
  if (failed != std::string::npos) {
    const std::size_t end = text.find("): ", failed);
    if (end == std::string::npos) return {};
    std::string message = text.substr(end + 3);
    message.resize(message.find_last_not_of('\n') + 1);
    return {.finished = true, .exit_status = std::atoi(text.c_str() + failed + 9), .message = message};
  }
  return {.finished = text.ends_with("\ndone\n"), .exit_status = 0, .message = ""};
}

std::vector<RunStatus> SiteStatus(const fs::path& site, const std::vector<StageRunInfo>& graph) {
  const bool busy = SiteIsLocked(site);
  std::map<std::string, const StageRunInfo*> writer;
  for (const StageRunInfo& run : graph) {
    for (const std::string& output : run.outputs) writer[output] = &run;
  }
  std::map<std::string, RunStatus> by_name;
  // The graph has no cycle, but its lines come in any order: a run is judged after the writers of its inputs.
  const auto judge = [&](const auto& self, const StageRunInfo& run) -> const RunStatus& {
    if (const auto known = by_name.find(run.name); known != by_name.end()) return known->second;
    RunStatus status{.run = run, .state = RunState::kDone, .reason = ""};
    std::string waits_for;
    for (const std::string& input : run.inputs) {
      const auto found = writer.find(input);
      if (found == writer.end()) continue;
      if (self(self, *found->second).state != RunState::kDone && waits_for.empty()) waits_for = found->second->Title();
    }
    const std::optional<std::string> stale = WhyStale(site, run);
    const LogEnd log = stale && LogIsNewer(site, run) ? ReadLogEnd(site / "logs" / (run.name + ".log")) : LogEnd{};
    if (!waits_for.empty()) {
      status.state = RunState::kWaiting;
      status.reason = "for " + waits_for;
    } else if (stale && log.exit_status != 0) {
      status.state = RunState::kFailed;
      status.reason = log.message + " (logs/" + run.name + ".log)";
    } else if (stale && busy && LogIsNewer(site, run) && !log.finished) {
      status.state = RunState::kRunning;
    } else if (stale) {
      status.state = RunState::kStale;
      status.reason = *stale;
    }
    return by_name.emplace(run.name, std::move(status)).first->second;
  };
  std::vector<RunStatus> statuses;
  for (const StageRunInfo& run : graph) statuses.push_back(judge(judge, run));
  return statuses;
}

std::string StatusText(const std::vector<RunStatus>& statuses) {
  std::size_t width = 0;
  for (const RunStatus& status : statuses) width = std::max(width, status.run.Title().size());
  std::string text;
  std::size_t done = 0;
  for (const RunStatus& status : statuses) {
    std::string line = PaddedTo(width + 2, status.run.Title()) + Word(status.state);
    if (!status.reason.empty()) line += (status.state == RunState::kWaiting ? " " : ": ") + status.reason;
    text += line + "\n";
    if (status.state == RunState::kDone) ++done;
  }
  return text + NextRun(statuses) + std::to_string(done) + " of " + std::to_string(statuses.size()) +
         " stage runs are up to date\n";
}

}  // namespace pipeline
