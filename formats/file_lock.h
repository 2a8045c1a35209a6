// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace formats {

// Keeps other programs from changing `file` while it lives, by a lock on the hidden file .NAME.lock beside it; waits
// until it has it. Folders are made. DataError when the folder is not writable.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace formats
