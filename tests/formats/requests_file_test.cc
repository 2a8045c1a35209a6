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
  ListedRequest request{.block = "B1", .causes = {{"break", score, "no scan for 3 s"}}, .score_m = score};
  request.id = IdOfRequest("B1", std::to_string(stamp), "break");
  request.picture = "requests/" + request.id + ".png";
  request.subject = ListedPose{.stamp_ns = stamp,
                               .from_ns = stamp - 5,
                               .until_ns = stamp + 5,
                               .estimate = {500100.00049, 5600200.1, 0.5},
                               .points = {{1.5F, -0.25F}}};
  return request;
}

// A line of 2 m that its scans have moved north by 1 m.
survey::AppliedEdit MovedWall() {
  survey::AppliedEdit wall{.edit = {.uid = "wall", .kind = survey::EditKind::kLineOccupied}};
  wall.edit.parts = {{{500099.0, 5600201.0}, {500101.0, 5600201.0}}};
  wall.drawn = {{{500099.0, 5600200.0}, {500101.0, 5600200.0}}};
  return wall;
}

struct RequestsFile : public testing::Test {
  RequestsFile() {
    list.requests = {Request(976052890247140001, 0.5), Request(976052890247140009, 0.9)};
    std::get<ListedPose>(list.requests[1].subject).answer = {"B1/answers/q.json", survey::Decision::kConfirm,
                                                             976052890247140010};
    list.requests.push_back(
        {.id = "B1-wall-edit_review", .block = "B1", .causes = {{"edit_review", 0.7, "bent"}}, .score_m = 0.7});
    list.requests.back().subject = MovedWall();
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
  ASSERT_EQ(read.size(), 4U);
  EXPECT_EQ(read[0]["num_requests"], 3);
  EXPECT_EQ(read[1]["kind"], "edit");
  EXPECT_EQ(read[1]["edit"]["uid"], "wall");
  EXPECT_EQ(read[1]["edit"]["geometry"]["coordinates"][0][1], 5600201.0);
  EXPECT_EQ(read[1]["drawn"]["coordinates"][0][1], 5600200.0);
  read.erase(read.begin() + 1);
  EXPECT_EQ(read[1]["rank"], 2);
  EXPECT_EQ(read[1]["kind"], "pose");
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

// Reads a picture of 480 x 480 pixels that is centred on a place and 12 m wide.
class Picture {
 public:
  using Colour = std::array<std::uint8_t, 3>;  // red, green, blue

  explicit Picture(const std::filesystem::path& file) {
    GDALAllRegister();
    data_.reset(GDALDataset::Open(file.c_str()));
    EXPECT_TRUE(data_ && data_->GetRasterXSize() == 480 && data_->GetRasterYSize() == 480);
  }
  Colour At(double east, double north) const {
    Colour colour{};
    EXPECT_EQ(data_->RasterIO(GF_Read, static_cast<int>(240 + 40 * east), static_cast<int>(240 - 40 * north), 1, 1,
                              colour.data(), 1, 1, GDT_Byte, 3, nullptr, 0, 0, 0, nullptr),
              CE_None);
    return colour;
  }

 private:
  GDALDatasetUniquePtr data_;
};

// 10 m x 10 m, free, with a wall 2 m east of E 500100, N 5600200.
survey::SiteRaster MapWithWall() {
  survey::SiteRaster map{.cell_size_m = 0.1, .min_column = 5000950, .min_row = 56001950, .width = 100, .height = 100};
  map.log_odds.assign(10000, -3.0F);
  for (int row = 0; row < 100; ++row) map.At(70, row) = 3.0F;
  return map;
}

// The scan of the wall, and a mode that lies 1 m too far west.
TEST(RequestPicture, ShowsMapScanAndModesWhereTheyLie) {
  const ScratchFolder scratch;
  const survey::SiteRaster map = MapWithWall();
  const survey::Pose2 estimate{500100.0, 5600200.0, 0.0};
  WriteRequestPicture(scratch / "r.png", survey::StripsOf(map),
                      {.estimate = estimate, .modes = {{500099.0, 5600200.0, 0.0}}, .points = {{2.05F, 1.0F}}});
  const Picture picture(scratch / "r.png");
  EXPECT_LT(picture.At(2.05, 3.0)[1], 110);                            // the wall
  EXPECT_EQ(picture.At(3.0, -3.0), (Picture::Colour{255, 255, 255}));  // free
  EXPECT_EQ(picture.At(-5.5, 0.0), (Picture::Colour{236, 236, 236}));  // beyond the map
  EXPECT_EQ(picture.At(2.05, 1.0), (Picture::Colour{220, 40, 40}));    // the scan
  EXPECT_EQ(picture.At(1.05, 1.0), (Picture::Colour{0, 120, 220}));    // the mode
}

TEST(EditPicture, ShowsWhereTheEditLiesAndWhereItWasDrawn) {
  const ScratchFolder scratch;
  const survey::SiteRaster map = MapWithWall();
  WriteEditPicture(scratch / "e.png", survey::StripsOf(map), MovedWall());
  const Picture picture(scratch / "e.png");                           // centred between the two
  EXPECT_EQ(picture.At(0.5, 0.5), (Picture::Colour{220, 40, 40}));    // now
  EXPECT_EQ(picture.At(0.5, -0.5), (Picture::Colour{40, 150, 60}));   // as drawn
  EXPECT_EQ(picture.At(0.5, 2.0), (Picture::Colour{255, 255, 255}));  // free
  EXPECT_LT(picture.At(2.05, 3.0)[1], 110);                           // the wall
}

}  // namespace
}  // namespace formats
