// SPDX-License-Identifier: Apache-2.0
//
// What is done and what is not, stage by stage, by the same rules that plumbline.mk uses.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pipeline {

// One run of one stage, as `make graph` prints it. Paths are relative to the site.
struct StageRunInfo {
  std::string name;  // "B1-track", "network"
  std::string stage;
  std::string block;  // empty for the stages of the site
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::string command;

  std::string Title() const { return block.empty() ? stage : block + " " + stage; }
};

enum class RunState { kDone, kStale, kWaiting, kFailed, kRunning };

struct RunStatus {
  StageRunInfo run;
  RunState state = RunState::kDone;
  std::string reason;  // why it is stale, what it waits for, how it failed
};

// Asks make for the graph (plumbline must be on PATH). DataError when make cannot read the site.
std::vector<StageRunInfo> ReadGraph(const std::filesystem::path& site);

std::vector<RunStatus> SiteStatus(const std::filesystem::path& site, const std::vector<StageRunInfo>& graph);

// The table and the closing line of `plumbline status`.
std::string StatusText(const std::vector<RunStatus>& statuses);

// How the log of a run ends.
struct LogEnd {
  bool finished = false;  // false: no log, killed, or still running
  int exit_status = 0;
  std::string message;
};
LogEnd ReadLogEnd(const std::filesystem::path& log);

}  // namespace pipeline
