// SPDX-License-Identifier: Apache-2.0
//
// Cloud files, and plumbline-reference on the small garage's simulated scanner against the exact truth.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/cloud_file.h"
#include "formats/cloud_tiles.h"
#include "formats/errors.h"
#include "formats/features_csv.h"
#include "survey/stats/philox.h"
#include "tests/support/command.h"
#include "tests/support/paths.h"
#include "tests/support/scratch_folder.h"

namespace {

std::vector<Eigen::Vector3d> Read(const std::filesystem::path& file, const std::string& content,
                                  formats::CloudCount* count = nullptr) {
  formats::WriteFileAtomically(file, content);
  std::vector<Eigen::Vector3d> points;
  const formats::CloudCount counted = formats::ReadCloud(file, [&](const Eigen::Vector3d& p) { points.push_back(p); });
  if (count != nullptr) *count = counted;
  return points;
}

template <typename... Values>
std::string Bytes(Values... values) {
  std::string text;
  (text.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return text;
}

TEST(CloudFileTest, ReadsPlyAndPcdInBothEncodings) {
  const test_support::ScratchFolder scratch;
  const std::vector<Eigen::Vector3d> expected = {{1, 2, 3}, {-4, 0.5, 6}};
  formats::CloudCount count;
  const std::string ply =
      "element vertex 2\nproperty uchar red\nproperty float x\nproperty double y\nproperty float z\n";
  EXPECT_EQ(Read(scratch / "a.ply", "ply\nformat ascii 1.0\ncomment c\n" + ply + "end_header\n9 1 2 3\n8 -4 0.5 6\n"),
            expected);
  const std::string records = Bytes(std::uint8_t{9}, 1.0F, 2.0, 3.0F) + Bytes(std::uint8_t{8}, -4.0F, 0.5, 6.0F);
  EXPECT_EQ(Read(scratch / "a.ply", "ply\nformat binary_little_endian 1.0\n" + ply + "end_header\n" + records),
            expected);
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ";
  EXPECT_EQ(Read(scratch / "a.pcd", pcd + "ascii\n1 2 3 7\nnan nan nan 0\n-4 0.5 6 7\n", &count), expected);
  EXPECT_EQ(count.num_invalid, 1);
  const std::uint32_t rgb = 7;
  EXPECT_EQ(Read(scratch / "a.pcd", pcd + "binary\n" + Bytes(1.0F, 2.0F, 3.0F, rgb) +
                                        Bytes(std::nanf(""), 0.0F, 0.0F, rgb) + Bytes(-4.0F, 0.5F, 6.0F, rgb)),
            expected);
}

// Points on a border lie in both tiles and belong to one; coordinates of a projection keep their millimetres.
TEST(CloudTilesTest, EachPointHasOneTileAndItsNeighbours) {
  const test_support::ScratchFolder scratch;
  const std::vector<Eigen::Vector3d> points = {
      {500000.1, 5600003.0, 112.5}, {500009.95, 5600003.0, 112.5}, {500010.0, 5600003.0, 112.5}, {-0.05, 5.0, 1.0}};
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n";
  for (const Eigen::Vector3d& p : points) ply += Bytes(p.x(), p.y(), p.z());
  formats::WriteFileAtomically(scratch / "a.ply", ply);
  std::vector<Eigen::Vector3d> held;
  std::size_t num_points = 0;
  formats::ForEachTile(scratch / "a.ply", scratch / "tiles", {.tile_m = 10.0, .margin_m = 0.2},
                       [&](const formats::CloudTile& tile) {
                         num_points += tile.points.size();
                         for (const Eigen::Vector3f& p : tile.points) {
                           if (tile.Holds(p.cast<double>())) held.emplace_back(tile.origin + p.cast<double>());
                         }
                       });
  EXPECT_EQ(num_points, 8U);  // each of them near a border in x
  ASSERT_EQ(held.size(), points.size());
  for (const Eigen::Vector3d& p : points) {
    EXPECT_TRUE(std::any_of(held.begin(), held.end(), [&](const auto& q) { return (p - q).norm() < 1e-4; }));
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "tiles"));
}

TEST(CloudFileTest, ReadsIntensities) {
  const test_support::ScratchFolder scratch;
  const std::string axes = "property float x\nproperty float y\nproperty float z\n";
  const auto intensity_of = [&](const std::string& content) {
    formats::WriteFileAtomically(scratch / "a.ply", content);
    float intensity = 0.0F;
    formats::ReadCloudPoints(scratch / "a.ply", [&](const formats::CloudPoint& point) { intensity = point.intensity; });
    return intensity;
  };
  const std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + axes;
  EXPECT_EQ(
      intensity_of(binary + "property ushort intensity\nend_header\n" + Bytes(1.0F, 2.0F, 3.0F, std::uint16_t{700})),
      700.0F);
  EXPECT_EQ(intensity_of("ply\nformat ascii 1.0\nelement vertex 1\n" + axes +
                         "property float scalar_Intensity\nend_header\n1 2 3 0.5\n"),
            0.5F);
  EXPECT_TRUE(std::isnan(intensity_of(binary + "end_header\n" + Bytes(1.0F, 2.0F, 3.0F))));
}

TEST(CloudFileTest, RefusesWhatItCannotRead) {
  const test_support::ScratchFolder scratch;
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
  for (const auto& [content, rule] : {std::pair<std::string, std::string>{"", "cut off"},
                                      {"hello\n", "neither PLY nor PCD"},
                                      {"ply\nformat binary_big_endian 1.0\n", "little-endian"},
                                      {head + "end_header\n1 2\n", "has no z"},
                                      {head + "property float z\nend_header\n1 2\n", "too few values"},
                                      {head + "property float z\nend_header\nnan 1 2\n", "no finite point"},
                                      {"ply\nformat ascii 1.0\nelement vertex -1\n", "no number of points"},
                                      {"VERSION 0.7\nFIELDS x y z\nSIZE 4 4\n", "a word for each field"},
                                      {"VERSION 0.7\nDATA binary_compressed\n", "ascii or binary"}}) {
    try {
      Read(scratch / "a.cloud", content);
      ADD_FAILURE() << rule;
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(rule), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("a.cloud"), std::string::npos) << error.what();
    }
  }
}

TEST(CloudFileTest, DamagedFilesAreReadOrRefused) {
  const test_support::ScratchFolder scratch;
  const std::string pcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 2\nDATA binary\n" +
                          Bytes(1.0F, 2.0F, 3.0F) + Bytes(4.0F, 5.0F, 6.0F);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n4 5 6\n";
  const survey::RandomStream random(9, 0, 0);
  for (std::uint64_t i = 0; i < 400; ++i) {
    const auto bits = random.Bits(i);
    std::string text = i % 2 == 0 ? pcd : ply;
    text[bits[0] % text.size()] = static_cast<char>(bits[1]);
    if (bits[2] % 8 == 0) text.resize(bits[3] % text.size());
    try {
      EXPECT_LE(Read(scratch / "a.cloud", text).size(), 2U);
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find("a.cloud"), std::string::npos) << error.what();
    }
  }
}

class ReferenceStageTest : public testing::Test {
 protected:
  static const std::filesystem::path& Field() {
    static const test_support::ScratchFolder scratch;
    static const std::filesystem::path field = scratch / "field";
    static const int status =
        test_support::RunCommand({"plumbline-simulate", "--scenario",
                                  (test_support::SourceFolder() / "examples/parking-garage/small.toml").string(),
                                  "--output", field.string()})
            .status;
    EXPECT_EQ(status, 0);
    return field;
  }
  static std::map<std::string, Eigen::Vector2d> Truth() {
    std::map<std::string, Eigen::Vector2d> truth;
    std::istringstream rows(formats::ReadWholeFile(Field() / "truth/features.csv"));
    std::string line;
    std::getline(rows, line);
    for (std::string name, northing, easting; std::getline(rows, line);) {
      std::istringstream row(line);
      std::getline(row, name, ',') && std::getline(row, northing, ',') && std::getline(row, easting, ',');
      truth[name] = {std::stod(easting), std::stod(northing)};
    }
    return truth;
  }
  test_support::CommandResult Run(const std::string& targets, std::vector<std::string> slice = {"112.6", "114.4"}) {
    return test_support::RunCommand({"plumbline-reference", "--cloud", (Field() / "reference/cloud.ply").string(),
                                     "--targets", targets, "--features", (Field() / "control/features.csv").string(),
                                     "--slice-from-m", slice[0], "--slice-to-m", slice[1], "--output",
                                     (scratch_ / "out").string()});
  }
  test_support::ScratchFolder scratch_;
};

TEST_F(ReferenceStageTest, FeaturesLieWhereTheyAre) {
  const test_support::CommandResult result = Run((Field() / "reference/targets.csv").string());
  ASSERT_EQ(result.status, 0) << result.err;
  const std::map<std::string, Eigen::Vector2d> truth = Truth();
  const std::vector<survey::NamedFeature> features = formats::ReadFeaturesCsv(scratch_ / "out/features.csv");
  // Of some pillars the scanner saw two faces only: those are told, not guessed.
  EXPECT_GE(features.size(), truth.size() * 3 / 4) << result.err;
  EXPECT_GE(std::count_if(features.begin(), features.end(),
                          [](const auto& feature) { return feature.kind == survey::FeatureKind::kPillar; }),
            3);
  double squares = 0.0;
  double normalized = 0.0;
  for (const survey::NamedFeature& feature : features) {
    const Eigen::Vector2d error = feature.position_in_site - truth.at(feature.name);
    EXPECT_LT(error.norm(), 0.01) << feature.name;
    squares += error.squaredNorm();
    normalized += error.dot(feature.covariance.inverse() * error);
  }
  const auto count = static_cast<double>(features.size());
  EXPECT_LT(std::sqrt(squares / count), 0.004);
  // The targets' errors are the same for all features: two or three degrees of freedom, whatever their number.
  EXPECT_LT(std::sqrt(normalized / (2 * count)), 1.6);
  EXPECT_GT(std::sqrt(normalized / (2 * count)), 0.4);
}

// The map of a block, read at the features of the reference: what is found differs as both covariances say.
TEST_F(ReferenceStageTest, TheMapShowsTheSameFeatures) {
  ASSERT_EQ(Run((Field() / "reference/targets.csv").string()).status, 0);
  const auto run = [&](std::vector<std::string> command) {
    command.insert(command.begin() + 1, {"--quiet"});
    const test_support::CommandResult result = test_support::RunCommand(command, scratch_.path().string());
    EXPECT_EQ(result.status, 0) << result.err;
  };
  const std::string raw = Field() / "blocks/B1";
  run({"plumbline-ingest", "--raw", raw + "/scans.csv", raw + "/imu.csv", raw + "/odometry.csv", "--marks",
       raw + "/marks.csv", "--mark-sigma-m", "0.003", "--output", "session"});
  run({"plumbline-track", "--session", "session", "--output", "track"});
  run({"plumbline-loops", "--session", "session", "--track", "track", "--output", "loops"});
  run({"plumbline-network", "--control", Field() / "control/points.csv", "--crs", "EPSG:25832", "--marks",
       "B1=" + raw + "/marks.csv", "--output", "control"});
  run({"plumbline-adjust", "--track", "track", "--loops", "loops", "--control", "control", "--output", "solution"});
  run({"plumbline-grid", "--session", "session", "--solution", "solution", "--output", "grid.tif"});
  run({"plumbline-features", "--map", "grid.tif", "--session", "session", "--solution", "solution", "--features",
       "out/features.csv", "--output", "features"});
  std::map<survey::FeatureKind, int> found;
  double normalized = 0.0;
  const std::vector<survey::NamedFeature> reference = formats::ReadFeaturesCsv(scratch_ / "out/features.csv");
  const std::vector<survey::MapFeature> in_map = formats::ReadFeatures(scratch_ / "features");
  for (std::size_t i = 0; i < reference.size(); ++i) {
    ASSERT_EQ(in_map.at(i).name, reference[i].name);
    if (!in_map[i].found) continue;
    ++found[reference[i].kind];
    const Eigen::Vector2d difference = in_map[i].position_in_site - reference[i].position_in_site;
    EXPECT_LT(difference.norm(), 0.025) << reference[i].name;  // half a cell
    normalized += difference.dot((in_map[i].covariance + reference[i].covariance).inverse() * difference);
  }
  EXPECT_GE(found[survey::FeatureKind::kCorner], 12);
  EXPECT_GE(found[survey::FeatureKind::kPillar], 1);
  const int count = found[survey::FeatureKind::kCorner] + found[survey::FeatureKind::kPillar];
  EXPECT_NEAR(std::sqrt(normalized / (2 * count)), 1.0, 0.5);  // four control points: few degrees of freedom
}

TEST_F(ReferenceStageTest, WhatCannotBePlacedIsRefused) {
  ASSERT_EQ(Run((Field() / "reference/targets.csv").string()).status, 0);
  const std::string before = formats::ReadWholeFile(scratch_ / "out/reference.json");
  EXPECT_NE(before.find("\"scale_minus_one_ppm\""), std::string::npos);
  formats::WriteFileAtomically(scratch_ / "two.csv",
                               "target,northing,easting,elevation,sigma_m,radius_m\nS1,1,2,3,0.003,0.0725\n"
                               "S2,5,2,3,0.003,0.0725\n");
  const test_support::CommandResult few = Run((scratch_ / "two.csv").string());
  EXPECT_EQ(few.status, 1);
  EXPECT_NE(few.err.find("needs three targets at least, 2 listed"), std::string::npos) << few.err;
  EXPECT_EQ(Run((Field() / "reference/targets.csv").string(), {"113", "112"}).status, 2);
  EXPECT_EQ(formats::ReadWholeFile(scratch_ / "out/reference.json"), before);
}

}  // namespace
