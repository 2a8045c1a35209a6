// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/anchoring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "survey/submaps/block_raster.h"
#include "survey/submaps/drawn_by.h"
#include "tests/support/room.h"

namespace survey {
namespace {

using Eigen::Vector2d;

// Two laps of a ring of corridors as a track without loops and control has them: the heading drifts, so that the second
// lap lies metres beside the first and the map shows every wall twice.
struct DriftedBlock {
  Session session;
  std::vector<Pose2> truth;
  std::vector<Pose2> drifted;
  SiteRaster map;  // drawn at the drifted poses

  BlockPoses At(const std::vector<Pose2>& poses) const {
    BlockPoses block{.stamps = {}, .site_from_scan = poses};
    for (const Scan& scan : session.scans) block.stamps.push_back(scan.stamp_ns);
    return block;
  }
};

DriftedBlock MakeDriftedBlock() {
  DriftedBlock block;
  block.truth = test_support::LapsOfTheRing(2);
  block.session = test_support::SimulateSession(test_support::Ring(), block.truth, 5.0, 0.01, 1.0, 0.0);
  block.drifted = {block.truth.front()};
  for (std::size_t i = 1; i < block.truth.size(); ++i) {
    Pose2 motion = Between(block.truth[i - 1], block.truth[i]);
    motion.theta += 0.0015 * motion.Translation().norm();
    motion.x *= 1.01;
    block.drifted.push_back(block.drifted.back() * motion);
  }
  block.map = WholeOf(RenderBlock(block.session, block.drifted, {}));
  FillDrawnBy(block.session, block.drifted, {}, &block.map);
  return block;
}

// What the adjustment leaves: 2 cm and 1 mrad.
std::vector<Pose2> Adjusted(const std::vector<Pose2>& truth) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  std::vector<Pose2> poses = truth;
  for (Pose2& pose : poses)
    pose = {pose.x + 0.02 * noise(random), pose.y + 0.02 * noise(random), pose.theta + 0.001 * noise(random)};
  return poses;
}

double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST(Anchoring, VerticesStayOnTheirWallsWhenADriftOfMetresIsCorrected) {
  const DriftedBlock block = MakeDriftedBlock();
  const BlockPoses before = block.At(block.drifted);
  const BlockPoses after = block.At(Adjusted(block.truth));
  std::vector<double> anchored;
  std::vector<double> not_anchored;
  // A person draws along what some scan sees: two beams of it, 1 m apart or so.
  for (std::size_t i = 5; i < block.truth.size(); i += 7) {
    const Scan& scan = block.session.scans[i];
    const ScanGeometry& geometry = block.session.geometries.front();
    MapEdit edit{.kind = EditKind::kLineOccupied, .parts = {{}}};
    std::vector<Vector2d> true_places;
    for (const int beam : {geometry.num_beams / 4, geometry.num_beams / 4 + 8}) {
      const double range = static_cast<double>(scan.ranges_m[static_cast<std::size_t>(beam)]);
      if (!std::isfinite(range) || range > 8.0) continue;
      const double angle = geometry.angle_min_rad + beam * geometry.angle_increment_rad;
      const Vector2d p_in_scan(range * std::cos(angle), range * std::sin(angle));
      const Vector2d drawn = block.drifted[i] * p_in_scan;
      const auto cell = block.map.CellOf(drawn);
      if (!(block.map.At(static_cast<int>(cell.x()), static_cast<int>(cell.y())) > 0.0F)) continue;  // not to be seen
      edit.parts.front().push_back(drawn);
      true_places.push_back(block.truth[i] * p_in_scan);
    }
    if (true_places.size() < 2) continue;
    const AppliedEdit moved = MovedWithScans(edit, AnchorsOf(edit, block.map, before), after);
    for (std::size_t k = 0; k < true_places.size(); ++k) {
      anchored.push_back((moved.edit.parts.front()[k] - true_places[k]).norm());
      not_anchored.push_back((edit.parts.front()[k] - true_places[k]).norm());
    }
  }
  ASSERT_GT(anchored.size(), 100U);
  EXPECT_LT(Quantile(anchored, 0.95), 0.2);
  EXPECT_LT(Quantile(anchored, 0.5), 0.06);
  EXPECT_GT(Quantile(not_anchored, 0.95), 2.0);
  RecordProperty("anchored_95", std::to_string(Quantile(anchored, 0.95)));
  RecordProperty("anchored_50", std::to_string(Quantile(anchored, 0.5)));
  RecordProperty("not_anchored_50", std::to_string(Quantile(not_anchored, 0.5)));
  RecordProperty("not_anchored_95", std::to_string(Quantile(not_anchored, 0.95)));
}

TEST(Anchoring, ThePartUnderAnEditTellsTheSameScansAsTheWholeMap) {
  const DriftedBlock block = MakeDriftedBlock();
  const BlockPoses poses = block.At(block.drifted);
  int same = 0;
  int count = 0;
  for (std::size_t i = 0; i < block.drifted.size(); i += 41) {
    const Vector2d place = block.drifted[i] * Vector2d(0.8, 0.6);
    const MapEdit edit{.kind = EditKind::kLineOccupied, .parts = {{place, place + Vector2d(0.5, 0.0)}}};
    SiteRaster part = PartAround(edit, block.map);
    EXPECT_LT(part.width * part.height, 1000);
    FillDrawnBy(block.session, block.drifted, {}, &part);
    same += AnchorsOf(edit, part, poses) == AnchorsOf(edit, block.map, poses) ? 1 : 0;
    ++count;
  }
  EXPECT_GT(count, 4);
  EXPECT_GE(same, count - 1) << "rays along the border of a cell round another way";
}

// 10 x 10 cells of 0.1 m, the left half drawn by scan 0, the right one by scan 1; the top row by none.
SiteRaster TwoHalves() {
  SiteRaster raster{.cell_size_m = 0.1, .min_column = 0, .min_row = 0, .width = 10, .height = 10};
  raster.log_odds.assign(100, 1.0F);
  for (int i = 0; i < 100; ++i) raster.drawn_by.push_back(i >= 90 ? NAN : i % 10 < 5 ? 0.0F : 1.0F);
  return raster;
}

TEST(Anchoring, EachVertexMovesWithTheScanUnderIt) {
  const BlockPoses before{.stamps = {10, 20}, .site_from_scan = {{0, 0, 0}, {1, 0, 0}}};
  const BlockPoses after{.stamps = {10, 20}, .site_from_scan = {{0, 0.3, 0}, {1, 0, 0}}};
  const MapEdit edit{.kind = EditKind::kLineOccupied, .parts = {{{0.25, 0.5}, {0.75, 0.5}}}};
  const auto anchors = AnchorsOf(edit, TwoHalves(), before);
  ASSERT_TRUE(anchors[0] && anchors[1]);
  EXPECT_EQ(anchors[0]->stamp_ns, 10);
  EXPECT_EQ(anchors[1]->stamp_ns, 20);
  const AppliedEdit moved = MovedWithScans(edit, anchors, after);
  EXPECT_NEAR((moved.edit.parts[0][0] - Vector2d(0.25, 0.8)).norm(), 0, 1e-12);
  EXPECT_NEAR((moved.edit.parts[0][1] - Vector2d(0.75, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR(moved.shift_m, 0.3, 1e-12);
  EXPECT_GT(moved.residual_m, 0.03);
  EXPECT_EQ(moved.anchored, 2);
}

TEST(Anchoring, AVertexOnNothingGoesWithTheOthersAndLostScansAreCounted) {
  const BlockPoses before{.stamps = {10, 20}, .site_from_scan = {{0, 0, 0}, {1, 0, 0}}};
  const MapEdit edit{.kind = EditKind::kAreaFree, .parts = {{{0.25, 0.5}, {0.75, 0.5}, {0.5, 7.0}}}};
  const auto anchors = AnchorsOf(edit, TwoHalves(), before);
  EXPECT_FALSE(anchors[2]);
  const AppliedEdit moved =
      MovedWithScans(edit, anchors, {.stamps = {10, 20}, .site_from_scan = {{2, 0, 0}, {3, 0, 0}}});
  EXPECT_NEAR((moved.edit.parts[0][2] - Vector2d(2.5, 7.0)).norm(), 0, 1e-12);
  EXPECT_NEAR(moved.residual_m, 0, 1e-9);
  EXPECT_NEAR(moved.area_change, 0, 1e-9);
  const AppliedEdit lost =
      MovedWithScans(edit, anchors, {.stamps = {11, 20}, .site_from_scan = {{2, 0, 0}, {3, 0, 0}}});
  EXPECT_EQ(lost.lost, 1);
  EXPECT_EQ(lost.anchored, 1);
}

TEST(Anchoring, LongLinesGetVertices) {
  const MapEdit line{.kind = EditKind::kLineFree, .parts = {{{0, 0}, {5, 0}, {5, 2}}}};
  const MapEdit dense = Densified(line, 2.0);
  ASSERT_EQ(dense.parts[0].size(), 5U);
  EXPECT_NEAR(dense.parts[0][1].x(), 5.0 / 3, 1e-12);
  EXPECT_EQ(dense.parts[0].back(), Vector2d(5, 2));
  const MapEdit area{.kind = EditKind::kForbidden, .parts = {{{0, 0}, {4, 0}, {4, 2}}}};
  EXPECT_EQ(Densified(area, 2.0).parts[0].size(), 2U + 1U + 3U);
}

}  // namespace
}  // namespace survey
