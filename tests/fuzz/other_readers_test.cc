// SPDX-License-Identifier: Apache-2.0
//
// Damaged GeoTIFF and JSON artefacts: the examination ends, and readers give what was written or a DataError.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/artefact_check.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/raster_file.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::RandomArtefacts;
using test_support::ScratchFolder;

void WriteBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string Damaged(std::string bytes, RandomArtefacts& random) {
  if (random.Below(5) == 0) return bytes.substr(0, random.Below(bytes.size()));
  for (std::uint64_t edits = 1 + random.Below(3); edits > 0; --edits) {
    // The directory of a TIFF and the start of a JSON text are at the front.
    const std::size_t offset = random.Below(random.Coin() ? std::min<std::size_t>(400, bytes.size()) : bytes.size());
    bytes[offset] = static_cast<char>(random.Below(256));
  }
  return bytes;
}

TEST(DamagedFiles, GeoTiff) {
  const ScratchFolder folder;
  RandomArtefacts random(51);
  survey::SiteRaster raster{
      .cell_size_m = 0.05, .min_column = 10000000, .min_row = 112000000, .width = 300, .height = 200};
  for (int i = 0; i < 300 * 200; ++i) raster.log_odds.push_back(static_cast<float>(random.Real(4.0)));
  const RasterLabel label{{"EPSG:25832", ""}, true};
  WriteRaster(folder / "whole.tif", raster, label, random.Provenance(2));
  ASSERT_EQ(CheckFile(folder / "whole.tif").state, FileState::kWhole);
  const std::string whole = ReadWholeFile(folder / "whole.tif");
  int broken = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    WriteBytes(folder / "damaged.tif", Damaged(whole, random));
    try {
      const survey::SiteRaster read = ReadRaster(folder / "damaged.tif");
      EXPECT_EQ(read.log_odds, raster.log_odds) << "damaged cells were taken for whole";
      EXPECT_EQ(read.min_column, raster.min_column);
      EXPECT_EQ(read.min_row, raster.min_row);
    } catch (const DataError&) {
    }
    broken += CheckFile(folder / "damaged.tif").state == FileState::kBroken ? 1 : 0;
  }
  EXPECT_GT(broken, kTrials * 3 / 4);
}

TEST(DamagedFiles, Json) {
  const ScratchFolder folder;
  RandomArtefacts random(52);
  const nlohmann::json json = {{"provenance", ToJson(random.Provenance(3))}, {"seams", {1.5, 2.5}}};
  const std::string whole = json.dump(2);
  WriteBytes(folder / "whole.json", whole);
  ASSERT_EQ(CheckFile(folder / "whole.json").state, FileState::kWhole);
  int whole_again = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    WriteBytes(folder / "damaged.json", Damaged(whole, random));
    whole_again += CheckFile(folder / "damaged.json").state == FileState::kWhole ? 1 : 0;
  }
  EXPECT_LT(whole_again, kTrials / 5);
}

}  // namespace
}  // namespace formats
