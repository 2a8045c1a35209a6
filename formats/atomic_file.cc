// SPDX-License-Identifier: Apache-2.0
#include "formats/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "formats/errors.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

void Sync(const fs::path& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  const bool failed = descriptor < 0 || fsync(descriptor) != 0;
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  if (failed) throw DataError(path.string() + ": could not be written to disk: " + std::strerror(reason));
}

bool SameContent(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (!fs::is_regular_file(b, error) || fs::file_size(a) != fs::file_size(b)) return false;
  std::ifstream file_a(a, std::ios::binary);
  std::ifstream file_b(b, std::ios::binary);
  std::vector<char> buffer_a(1 << 18);
  std::vector<char> buffer_b(1 << 18);
  while (file_a && file_b) {
    file_a.read(buffer_a.data(), static_cast<std::streamsize>(buffer_a.size()));
    file_b.read(buffer_b.data(), static_cast<std::streamsize>(buffer_b.size()));
    if (file_a.gcount() != file_b.gcount()) return false;
    if (std::memcmp(buffer_a.data(), buffer_b.data(), static_cast<std::size_t>(file_a.gcount())) != 0) return false;
  }
  return file_a.eof() && file_b.eof();
}

// Temporaries are named .tmp-PID-NAME: the prefix hides them from wildcards, the name keeps the extension.
constexpr std::string_view kPrefix = ".tmp-";

// A killed process that nobody has waited for yet (state Z) is still listed in /proc.
bool Runs(const std::string& pid) {
  std::ifstream stat("/proc/" + pid + "/stat");
  std::string text;
  if (!std::getline(stat, text)) return false;
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos || text.compare(name_end, 3, ") Z") != 0;
}

void RemoveLeftovers(const fs::path& target) {
  const std::string suffix = "-" + target.filename().string();
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(target.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    const std::size_t pid_end = name.find('-', kPrefix.size());
    if (pid_end == std::string::npos || name.compare(pid_end, suffix.size(), suffix) != 0) continue;
    // Also what a library left beside the temporary (SQLite's journal).
    const std::string pid = name.substr(kPrefix.size(), pid_end - kPrefix.size());
    if (pid.find_first_not_of("0123456789") != std::string::npos || Runs(pid)) continue;
    fs::remove(entry.path(), error);
  }
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  target_ = folder / target_.filename();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DataError(folder.string() + ": folder cannot be made: " + error.message());
  RemoveLeftovers(target_);
  temporary_ = folder / (std::string(kPrefix) + std::to_string(getpid()) + "-" + target_.filename().string());
  fs::remove(temporary_, error);
  if (access(folder.c_str(), W_OK) != 0)
    throw DataError(folder.string() + ": folder is not writable: " + std::strerror(errno));
}

AtomicFile::~AtomicFile() {
  std::error_code error;
  if (!temporary_.empty()) fs::remove(temporary_, error);
}

bool AtomicFile::Commit() {
  if (SameContent(temporary_, target_)) return false;
  Sync(temporary_, O_RDONLY);
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw DataError(target_.string() + ": could not be replaced: " + error.message());
  temporary_.clear();
  Sync(target_.parent_path(), O_RDONLY | O_DIRECTORY);
  return true;
}

bool WriteFileAtomically(const fs::path& target, std::string_view content) {
  AtomicFile file(target);
  std::ofstream out(file.temporary(), std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) throw DataError(target.string() + ": could not be written (disk full?)");
  return file.Commit();
}

std::string ReadWholeFile(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) throw DataError(file.string() + ": is a folder");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw DataError(file.string() + ": cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) throw DataError(file.string() + ": cannot be read to its end");
  return std::move(text).str();
}

}  // namespace formats
