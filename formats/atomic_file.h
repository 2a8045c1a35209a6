// SPDX-License-Identifier: Apache-2.0
//
// All outputs are written this way: to a temporary name in the same folder, synced, renamed. A killed writer leaves the
// old file or none. An output that comes out identical to what is there keeps the old file and its time stamp, so that
// `make` stops the chain there.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace formats {

// Usage: write to file.temporary(), close it, call Commit(). Without Commit the destructor removes the temporary.
class AtomicFile {
 public:
  // Creates missing parent folders. The temporary keeps the extension of `target` (GDAL picks formats by it).
  // Leftover temporaries of killed writers of the same target are removed. DataError when the folder is not writable.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }

  // True when the target changed; false when it already held the same bytes. DataError on a full disk or a failed
  // rename.
  bool Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

// Writes text (or bytes) whole. Returns as Commit.
bool WriteFileAtomically(const std::filesystem::path& target, std::string_view content);

// DataError names the file when it cannot be read.
std::string ReadWholeFile(const std::filesystem::path& file);

}  // namespace formats
