// SPDX-License-Identifier: Apache-2.0
#include "pipeline/subprocess.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "formats/errors.h"

extern char** environ;

namespace pipeline {
namespace {

std::vector<char*> Pointers(const std::vector<std::string>& argv) {
  std::vector<char*> pointers;
  for (const std::string& word : argv) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

pid_t Spawn(const std::vector<std::string>& argv, const posix_spawn_file_actions_t* actions) {
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, argv[0].c_str(), actions, nullptr, Pointers(argv).data(), environ);
  if (error != 0) throw formats::DataError(argv[0] + ": cannot be started: " + std::strerror(error));
  return pid;
}

int Wait(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::filesystem::path OwnFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

ProgramOutput RunAndRead(const std::vector<std::string>& argv) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw formats::DataError(std::string("pipe: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t pid = 0;
  try {
    pid = Spawn(argv, &actions);
  } catch (...) {
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  ProgramOutput output;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = read(ends[0], buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    output.out.append(buffer.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  output.status = Wait(pid);
  return output;
}

int RunAndWait(const std::vector<std::string>& argv) { return Wait(Spawn(argv, nullptr)); }

void Become(const std::vector<std::string>& argv) {
  execvp(argv[0].c_str(), Pointers(argv).data());
  throw formats::DataError(argv[0] + ": cannot be started: " + std::strerror(errno));
}

}  // namespace pipeline
