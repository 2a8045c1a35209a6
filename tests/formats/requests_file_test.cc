// SPDX-License-Identifier: Apache-2.0
#include "formats/requests_file.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/request_picture.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::ScratchFolder;

ListedRequest Request(survey::StampNs stamp, double score) {
  ListedRequest request{.block = "B1",
                        .stamp_ns = stamp,
                        .from_ns = stamp - 5,
                        .until_ns = stamp + 5,
                        .causes = {{"break", score, "no scan for 3 s"}},
                        .score_m = score,
                        .estimate = {500100.00049, 5600200.1, 0.5},
                        .points = {{1.5F, -0.25F}}};
  request.id = IdOfRequest("B1", stamp, "break");
  request.picture = "requests/" + request.id + ".png";
  return request;
}

struct RequestsFile : public testing::Test {
  RequestsFile() {
    list.requests = {Request(976052890247140001, 0.5), Request(976052890247140009, 0.9)};
    list.requests[1].answer = {"B1/answers/q.json", survey::Decision::kConfirm, 976052890247140010};
    Rank(&list.requests);
    list.blocks = {
        {.name = "B1", .tied = true, .crs = "EPSG:25832", .map = "B1/grid.tif", .review = {2, 1, 0, 1, 1, 50, 5}}};
    WriteRequests(file, list, {.records = {{.stage = "requests", .version = "1"}}});
  }
  ScratchFolder scratch;
  std::filesystem::path file = scratch / "requests.jsonl";
  RequestList list;
};

TEST_F(RequestsFile, OneLineForTheFileAndOneForEachRequestOpenOnesFirst) {
  std::istringstream lines(ReadWholeFile(file));
  std::vector<nlohmann::json> read;
  for (std::string line; std::getline(lines, line);) read.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[0]["num_requests"], 2);
  EXPECT_EQ(read[1]["rank"], 1);
  EXPECT_EQ(read[1]["id"], "B1-976052890247140001-break");
  EXPECT_EQ(read[1]["stamp_ns"], "976052890247140001");  // a double would end in ...000
  EXPECT_EQ(read[1]["estimate"]["x"], 500100.0);
  EXPECT_EQ(read[1]["points"][0][1], -0.25);
  EXPECT_TRUE(read[1]["answer"].is_null());
  EXPECT_EQ(read[2]["answer"]["decision"], "confirm");
}

TEST_F(RequestsFile, TheCertificateReadsTheCounts) {
  const std::vector<ListedBlock> blocks = ReadReviewedBlocks(file);
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].review.num_open, 1);
  EXPECT_EQ(blocks[0].review.ContradictedShare(), 0.1);
  EXPECT_EQ(ReadProvenance(file).Own().stage, "requests");
}

TEST_F(RequestsFile, AListThatWasCutOffIsRefused) {
  const std::string text = ReadWholeFile(file);
  for (const std::size_t length : {text.size() - 20, text.find('\n') + 1, std::size_t{30}}) {
    WriteFileAtomically(file, text.substr(0, length));
    EXPECT_THROW(ReadReviewedBlocks(file), DataError) << length;
  }
}

// A wall 2 m east of the scan, and the scan of it; a mode that lies 1 m too far west.
TEST(RequestPicture, ShowsMapScanAndModesWhereTheyLie) {
  const ScratchFolder scratch;
  survey::SiteRaster map{.cell_size_m = 0.1, .min_column = 5000950, .min_row = 56001950, .width = 100, .height = 100};
  map.log_odds.assign(10000, -3.0F);
  for (int row = 0; row < 100; ++row) map.At(70, row) = 3.0F;
  const survey::Pose2 estimate{500100.0, 5600200.0, 0.0};
  WriteRequestPicture(scratch / "r.png", survey::StripsOf(map),
                      {.estimate = estimate, .modes = {{500099.0, 5600200.0, 0.0}}, .points = {{2.05F, 1.0F}}});
  GDALAllRegister();
  const GDALDatasetUniquePtr picture(GDALDataset::Open((scratch / "r.png").c_str()));
  ASSERT_TRUE(picture);
  ASSERT_EQ(picture->GetRasterXSize(), 480);
  ASSERT_EQ(picture->GetRasterYSize(), 480);
  const auto at = [&](double east, double north) {
    std::array<std::uint8_t, 3> colour{};
    EXPECT_EQ(picture->RasterIO(GF_Read, static_cast<int>(240 + 40 * east), static_cast<int>(240 - 40 * north), 1, 1,
                                colour.data(), 1, 1, GDT_Byte, 3, nullptr, 0, 0, 0, nullptr),
              CE_None);
    return colour;
  };
  using Colour = std::array<std::uint8_t, 3>;         // red, green, blue
  EXPECT_LT(at(2.05, 3.0)[1], 110);                   // the wall
  EXPECT_EQ(at(3.0, -3.0), (Colour{255, 255, 255}));  // free
  EXPECT_EQ(at(-5.5, 0.0), (Colour{236, 236, 236}));  // beyond the map
  EXPECT_EQ(at(2.05, 1.0), (Colour{220, 40, 40}));    // the scan
  EXPECT_EQ(at(1.05, 1.0), (Colour{0, 120, 220}));    // the mode
}

}  // namespace
}  // namespace formats
