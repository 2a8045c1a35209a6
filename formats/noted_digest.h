// SPDX-License-Identifier: Apache-2.0
//
// The SHA-256 of an intermediate file that several stages read (a session of 100 MB is read by five), computed once.
//
// A note beside the file, .NAME.sha256, holds the digest and what the file system says of the file: inode, size, time
// of modification and time of change. The last one no program can set: whatever is written in place, renamed, copied,
// restored or touched gets another one, so that the note fits no more and the digest is computed anew. A note counts
// only when the file's times lay behind the file system's clock, by more than its tick, before the digest was begun
// (as in git's index: a second change within the tick would leave no trace). It is a line of its own with a checksum; a
// torn one counts as none, and where none can be written nothing is lost but the time.
#pragma once

#include <filesystem>
#include <string>

namespace formats {

// As Sha256OfFile.
std::string Sha256OfIntermediate(const std::filesystem::path& file);

// The note of a file, whether there is one or not.
std::filesystem::path DigestNoteOf(const std::filesystem::path& file);

}  // namespace formats
