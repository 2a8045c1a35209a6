// SPDX-License-Identifier: Apache-2.0
//
// Damaged artefacts: whatever the bytes, a reader gives the content that was written or a DataError that names the
// file; the examination finds what a reader refuses. Seeded, so that a failure can be repeated.
#include <gtest/gtest.h>

#include <fstream>

#include "formats/artefact_file.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::ArtefactCase;
using test_support::RandomArtefacts;
using test_support::ScratchFolder;

void WriteBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

enum class Outcome { kSameContent, kRefused };

class DamagedArtefacts : public testing::Test {
 protected:
  // Writes the damaged bytes, reads them and writes what was read again: that must give the bytes of the whole file.
  Outcome Try(const ArtefactCase& artefact, const std::string& damaged) {
    const auto file = folder_ / "damaged.sqlite";
    WriteBytes(file, damaged);
    try {
      artefact.copy(file, folder_ / "copy.sqlite");
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
      return Outcome::kRefused;
    }
    EXPECT_EQ(ReadWholeFile(folder_ / "copy.sqlite"), whole_) << "other content was taken for whole";
    return Outcome::kSameContent;
  }

  void Load(const ArtefactCase& artefact) {
    artefact.write(folder_ / "whole.sqlite");
    whole_ = ReadWholeFile(folder_ / "whole.sqlite");
    artefact.copy(folder_ / "whole.sqlite", folder_ / "copy.sqlite");  // so that later copies keep the file
    ASSERT_EQ(ReadWholeFile(folder_ / "copy.sqlite"), whole_);
  }

  const ScratchFolder folder_;
  std::string whole_;
};

TEST_F(DamagedArtefacts, SingleFlippedBytes) {
  for (const ArtefactCase& artefact : test_support::SmallArtefacts(21)) {
    Load(artefact);
    RandomArtefacts random(22);
    int refused = 0;
    constexpr int kTrials = 200;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::string damaged = whole_;
      // The headers of file and schema are small: a third of the trials goes there.
      const std::size_t offset = random.Below(trial % 3 == 0 ? 200 : damaged.size());
      damaged[offset] = static_cast<char>(damaged[offset] ^ static_cast<char>(1 + random.Below(255)));
      SCOPED_TRACE(artefact.name + ", byte " + std::to_string(offset));
      refused += Try(artefact, damaged) == Outcome::kRefused ? 1 : 0;
    }
    // Unused space and counters do not matter; the content does.
    EXPECT_GT(refused, kTrials / 10) << artefact.name;
  }
}

TEST_F(DamagedArtefacts, TruncatedFilesAreRefused) {
  for (const ArtefactCase& artefact : test_support::SmallArtefacts(23)) {
    Load(artefact);
    RandomArtefacts random(24);
    for (int trial = 0; trial < 60; ++trial) {
      const std::size_t length = trial < 30
                                     ? (whole_.size() * static_cast<std::size_t>(trial) / 30) & ~std::size_t{4095}
                                     : random.Below(whole_.size());
      SCOPED_TRACE(artefact.name + ", length " + std::to_string(length));
      EXPECT_EQ(Try(artefact, whole_.substr(0, length)), Outcome::kRefused);
    }
  }
}

TEST_F(DamagedArtefacts, RandomMutations) {
  for (const ArtefactCase& artefact : test_support::SmallArtefacts(25)) {
    Load(artefact);
    RandomArtefacts random(26);
    for (int trial = 0; trial < 80; ++trial) {
      std::string damaged = whole_;
      for (std::uint64_t edits = 1 + random.Below(4); edits > 0; --edits) {
        const std::size_t offset = random.Below(damaged.size());
        const std::size_t length = std::min<std::size_t>(1 + random.Below(600), damaged.size() - offset);
        switch (random.Below(4)) {
          case 0:  // zeros, as after a crash of the file system
            damaged.replace(offset, length, length, '\0');
            break;
          case 1:  // another place of the same file
            damaged.replace(offset, length, damaged.substr(random.Below(damaged.size() - length + 1), length));
            break;
          case 2:  // noise
            for (std::size_t i = 0; i < length; ++i) damaged[offset + i] = static_cast<char>(random.Below(256));
            break;
          case 3:  // a page lost
            damaged.erase(offset & ~std::size_t{4095}, 4096);
            if (damaged.empty()) damaged = "x";
            break;
        }
      }
      SCOPED_TRACE(artefact.name + ", trial " + std::to_string(trial));
      Try(artefact, damaged);
    }
  }
}

TEST_F(DamagedArtefacts, TheExaminationFindsWhatReadersRefuse) {
  for (const ArtefactCase& artefact : test_support::SmallArtefacts(27)) {
    Load(artefact);
    RandomArtefacts random(28);
    for (int trial = 0; trial < 40; ++trial) {
      std::string damaged = whole_;
      const std::size_t offset = random.Below(damaged.size());
      damaged[offset] = static_cast<char>(damaged[offset] ^ 0x55);
      SCOPED_TRACE(artefact.name + ", byte " + std::to_string(offset));
      const bool refused = Try(artefact, damaged) == Outcome::kRefused;
      const bool found = !ExamineArtefact(folder_ / "damaged.sqlite").empty();
      EXPECT_TRUE(found || !refused);
    }
  }
}

}  // namespace
}  // namespace formats
