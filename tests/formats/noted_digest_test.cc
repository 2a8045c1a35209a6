// SPDX-License-Identifier: Apache-2.0
//
// A noted digest must be that of the content, whatever was done to the file since.
#include "formats/noted_digest.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLarge = 5 << 20;

// Longer than the tick of a file system's clock: what follows gets other times, and what was noted counts.
void LetTheClockTick() { std::this_thread::sleep_for(std::chrono::milliseconds(60)); }

// A file large enough for a note, with one.
class NotedDigest : public testing::Test {
 protected:
  NotedDigest() {
    Write(std::string(kLarge, 'a'));
    LetTheClockTick();
    EXPECT_EQ(Sha256OfIntermediate(file_), Sha256OfFile(file_));
  }

  void Write(const std::string& content) const {
    std::ofstream(file_, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc) << content;
  }

  std::string Note() const { return ReadWholeFile(DigestNoteOf(file_)); }

  // Writes other digits into the note, with a checksum that fits: whoever believes the note tells them.
  std::string Forge() const {
    std::string note = Note();
    const std::size_t digest = note.find("sha256 ") + 7;
    const std::string forged(64, '0');
    note.replace(digest, 64, forged);
    const std::size_t check = note.find(" check ");
    note.replace(check + 7, 16, Sha256(note.substr(0, check)).substr(0, 16));
    WriteFileAtomically(DigestNoteOf(file_), note);
    return forged;
  }

  // Size and time of modification of `file` as before: all that make sees.
  void HideChange(const fs::path& file, const struct stat& before) const {
    const timespec times[2] = {before.st_atim, before.st_mtim};
    ASSERT_EQ(utimensat(AT_FDCWD, file.c_str(), times, 0), 0);
  }

  const test_support::ScratchFolder scratch_;
  const fs::path file_ = scratch_ / "session.sqlite";
};

TEST_F(NotedDigest, IsToldByTheNote) {
  const std::string forged = Forge();
  EXPECT_EQ(Sha256OfIntermediate(file_), forged);
}

TEST_F(NotedDigest, OtherContentOfTheSameSizeAndTimeIsSeen) {
  struct stat before {};
  ASSERT_EQ(stat(file_.c_str(), &before), 0);
  const std::string old = Sha256OfIntermediate(file_);
  Write(std::string(kLarge, 'b'));
  HideChange(file_, before);
  EXPECT_EQ(Sha256OfIntermediate(file_), Sha256(std::string(kLarge, 'b')));
  EXPECT_NE(Sha256OfIntermediate(file_), old);
}

TEST_F(NotedDigest, AnotherFileOfThatNameIsSeen) {
  struct stat before {};
  ASSERT_EQ(stat(file_.c_str(), &before), 0);
  WriteFileAtomically(scratch_ / "other", std::string(kLarge, 'c'));
  HideChange(scratch_ / "other", before);
  fs::rename(scratch_ / "other", file_);
  EXPECT_EQ(Sha256OfIntermediate(file_), Sha256(std::string(kLarge, 'c')));
}

TEST_F(NotedDigest, TouchedFilesAndCopiesAreReadAgain) {
  const std::string forged = Forge();
  fs::last_write_time(file_, fs::file_time_type::clock::now());
  LetTheClockTick();
  EXPECT_NE(Sha256OfIntermediate(file_), forged);
  Forge();
  fs::create_directories(scratch_ / "copy");
  fs::copy_file(file_, scratch_ / "copy/session.sqlite");
  fs::copy_file(DigestNoteOf(file_), DigestNoteOf(scratch_ / "copy/session.sqlite"));
  EXPECT_EQ(Sha256OfIntermediate(scratch_ / "copy/session.sqlite"), Sha256OfFile(file_));
}

TEST_F(NotedDigest, TornNotesCountAsNone) {
  const std::string note = Note();
  for (const std::string& torn :
       {std::string(), note.substr(0, note.size() / 2), note + note, std::string(note.size(), '\0'),
        std::string(note).replace(note.find("sha256 ") + 7, 4,
                                  note[note.find("sha256 ") + 7] == '0' ? "1111" : "0000")}) {
    WriteFileAtomically(DigestNoteOf(file_), torn);
    EXPECT_EQ(Sha256OfIntermediate(file_), Sha256OfFile(file_));
    EXPECT_EQ(Note(), note);
  }
}

// A second change within the clock's tick would leave no trace.
TEST_F(NotedDigest, NothingIsNotedOfAFileThatWasJustWritten) {
  Write(std::string(kLarge, 'd'));
  struct stat state {};
  ASSERT_EQ(stat(file_.c_str(), &state), 0);
  const timespec future[2] = {{.tv_sec = state.st_mtim.tv_sec + 100, .tv_nsec = 5},
                              {.tv_sec = state.st_mtim.tv_sec + 100, .tv_nsec = 5}};
  ASSERT_EQ(utimensat(AT_FDCWD, file_.c_str(), future, 0), 0);
  LetTheClockTick();
  EXPECT_EQ(Sha256OfIntermediate(file_), Sha256(std::string(kLarge, 'd')));
  EXPECT_EQ(Note(), "");
}

TEST_F(NotedDigest, WorksWhereNoNoteCanBeWritten) {
  fs::remove(DigestNoteOf(file_));
  fs::create_directories(DigestNoteOf(file_));
  EXPECT_EQ(Sha256OfIntermediate(file_), Sha256OfFile(file_));
}

TEST_F(NotedDigest, SmallFilesGetNone) {
  WriteFileAtomically(scratch_ / "small.sqlite", "small");
  LetTheClockTick();
  EXPECT_EQ(Sha256OfIntermediate(scratch_ / "small.sqlite"), Sha256("small"));
  EXPECT_FALSE(fs::exists(DigestNoteOf(scratch_ / "small.sqlite")));
}

}  // namespace
}  // namespace formats
