// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_lock.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <sstream>
#include <string>
#include <thread>

#include "formats/errors.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;

fs::path LockFile(const fs::path& site) { return site / "work" / ".lock"; }

struct Holder {
  pid_t pid = 0;
  std::string host;
};

Holder ReadHolder(int lock) {
  std::array<char, 300> text{};
  if (pread(lock, text.data(), text.size() - 1, 0) <= 0) return {};
  Holder holder;
  std::istringstream(text.data()) >> holder.pid >> holder.host;
  return holder;
}

bool MayStillRun(const Holder& holder) {
  return holder.host != HostName() || kill(holder.pid, 0) == 0 || errno == EPERM;
}

// The keeper of a make that has just ended needs a moment to notice it.
bool Acquire(int lock) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return true;  // a file system without locks
    if (MayStillRun(ReadHolder(lock))) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

// The child that holds the lock: closes everything else so that nobody waits for it, and waits for make's end.
[[noreturn]] void KeepUntilEndOf(int process) {
  setsid();
  const int nothing = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor <= 2; ++descriptor) dup2(nothing, descriptor);
  pollfd waiting{.fd = process, .events = POLLIN, .revents = 0};
  while (poll(&waiting, 1, -1) < 0 && errno == EINTR) {
  }
  _exit(0);
}

}  // namespace

std::string HostName() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

void LockSiteUntilEndOf(const fs::path& site, pid_t make) {
  fs::create_directories(site / "work");
  const int lock = open(LockFile(site).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) throw DataError(LockFile(site).string() + ": cannot be written: " + std::strerror(errno));
  if (!Acquire(lock)) {
    const Holder holder = ReadHolder(lock);
    close(lock);
    throw DataError("another make (process " + std::to_string(holder.pid) + " on " + holder.host +
                    ") is working on this site; wait for it or stop it");
  }
  const std::string text = std::to_string(make) + " " + HostName() + "\n";
  if (ftruncate(lock, 0) != 0 || pwrite(lock, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    throw DataError(LockFile(site).string() + ": cannot be written: " + std::strerror(errno));
  }
  const int process = static_cast<int>(syscall(SYS_pidfd_open, make, 0));
  if (process < 0) throw DataError("process " + std::to_string(make) + ": " + std::strerror(errno));
  if (fork() == 0) KeepUntilEndOf(process);
  close(process);
  close(lock);
}

bool SiteIsLocked(const fs::path& site) {
  const int lock = open(LockFile(site).c_str(), O_RDWR | O_CLOEXEC);
  if (lock < 0) return false;
  const bool locked = flock(lock, LOCK_EX | LOCK_NB) != 0 && MayStillRun(ReadHolder(lock));
  close(lock);
  return locked;
}

}  // namespace pipeline
