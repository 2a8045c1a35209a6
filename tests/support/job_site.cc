// SPDX-License-Identifier: Apache-2.0
#include "tests/support/job_site.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "tests/support/paths.h"

extern char** environ;

namespace test_support {
namespace {

namespace fs = std::filesystem;

// A program that is killed says nothing itself.
void Require(const CommandResult& result, const std::string& what) {
  if (result.status == 0) return;
  throw std::runtime_error(what + " ended with status " + std::to_string(result.status) +
                           (result.status > 128 ? " (killed by a signal)" : "") + "\nstderr: " + result.err +
                           "\nstdout: " + result.out);
}

void Collect(const fs::path& site, const std::string& folder, std::map<std::string, std::string>* results) {
  if (!fs::is_directory(site / folder)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(site / folder)) {
    const fs::path file = entry.path().lexically_relative(site);
    const bool internal =
        file.string().find("/.") != std::string::npos && file.string().find("/.tmp-") == std::string::npos;
    if (entry.is_regular_file() && !internal) (*results)[file.string()] = formats::Sha256OfFile(entry.path());
  }
}

}  // namespace

const fs::path& FieldDataOfTwoRooms() {
  static const ScratchFolder scratch;
  static const fs::path field = [] {
    Require(RunCommand({"plumbline-simulate", "--scenario", SourceFolder() / "tests/jobs/two_rooms.toml", "--output",
                        scratch / "field", "--quiet"}),
            "plumbline simulate");
    return scratch / "field";
  }();
  return field;
}

void ReplaceInFile(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = formats::ReadWholeFile(file);
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos) {
    throw std::runtime_error(file.string() + ": not exactly one \"" + from + "\"");
  }
  formats::WriteFileAtomically(file, text.replace(at, from.size(), to));
}

void AppendToFile(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::app | std::ios::binary) << text;
}

std::vector<std::string> Differences(const std::map<std::string, std::string>& a,
                                     const std::map<std::string, std::string>& b) {
  std::vector<std::string> files;
  for (const auto& [file, digest] : a) {
    const auto found = b.find(file);
    if (found == b.end() || found->second != digest) files.push_back(file);
  }
  for (const auto& [file, digest] : b) {
    if (!a.contains(file)) files.push_back(file);
  }
  return files;
}

JobSite::JobSite(fs::path folder) : site_(folder.empty() ? scratch_ / "site" : std::move(folder)) {
  const fs::path& field = FieldDataOfTwoRooms();
  Require(RunCommand({"plumbline", "new", site_, "--crs", "EPSG:25832", "--control", field / "control" / "points.csv",
                      "--block", "A=" + (field / "blocks" / "A").string(), "--block",
                      "B=" + (field / "blocks" / "B").string()}),
          "plumbline new");
}

// Time stamps matter to make, so they are copied too.
JobSite::JobSite(CopyOf copy) : site_(scratch_ / "site") {
  Require(RunCommand({"cp", "-a", copy.original.path(), site_}), "cp");
}

JobSite JobSite::Processed() {
  static const JobSite original;
  static const CommandResult run = original.Run({"-j2"});
  Require(run, "plumbline run");
  return JobSite(CopyOf{original});
}

CommandResult JobSite::Run(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {"plumbline", "run", site_.string()});
  return RunCommand(arguments);
}

std::vector<std::string> JobSite::StagesOfRun(std::vector<std::string> arguments) const {
  const CommandResult result = Run(std::move(arguments));
  std::vector<std::string> stages;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) stages.push_back(line);
  if (result.status != 0) stages.push_back("failed: " + result.err);
  std::sort(stages.begin(), stages.end());
  return stages;
}

bool JobSite::RunAndKillAfter(std::chrono::milliseconds delay) const {
  setenv("WEASYPRINT", "", 1);  // the PDF has a test of its own
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // a group of its own, so that all of it can be killed
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {1, 2}) posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  std::string program = BinFolder() / "plumbline";
  std::string run = "run";
  std::string site = site_.string();
  const std::array<char*, 4> argv = {program.data(), run.data(), site.data(), nullptr};
  pid_t pid = 0;
  const int error = posix_spawn(&pid, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error(program + " cannot be started");
  std::this_thread::sleep_for(delay);
  // Looked at without being waited for: until then nobody else gets the number of the group that is killed.
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT);
  const bool ended = info.si_pid == pid;
  kill(-pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  return !ended;
}

std::map<std::string, std::string> JobSite::Results() const {
  std::map<std::string, std::string> results;
  for (const char* folder : {"work", "out"}) Collect(site_, folder, &results);
  return results;
}

}  // namespace test_support
