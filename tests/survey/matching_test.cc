// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "survey/matching/branch_and_bound.h"
#include "survey/matching/coarse_search.h"
#include "survey/matching/gauss_newton.h"
#include "survey/sensors/scan_points.h"
#include "survey/stats/philox.h"
#include "survey/submaps/rendering.h"
#include "tests/support/room.h"

namespace survey {
namespace {

using Points = std::vector<Eigen::Vector2f>;

Points PointsFrom(const std::vector<test_support::Wall>& walls, const Pose2& pose, double sigma_m, std::uint32_t seed) {
  const ScanGeometry geometry = test_support::WideScanner(361);
  const ScanProjector projector(std::vector{geometry}, 30.0, 0.0);
  ScanPoints points;
  projector.Project(0, test_support::SimulateRanges(walls, pose, geometry, sigma_m, seed), {}, &points);
  return points.hits;
}

// Draws a scan as the tracker does: end points, free rays, surfaces between neighbouring end points.
void Draw(const Points& points_in_scan, const Pose2& map_from_scan, OccupancyPyramid* map) {
  Points surface;
  Points in_map;
  Points surface_in_map;
  SurfacePoints(points_in_scan, map->cell_size_m(), kMaxSurfaceGap_m, &surface);
  TransformPoints(map_from_scan, points_in_scan, &in_map);
  TransformPoints(map_from_scan, surface, &surface_in_map);
  map->Insert(map_from_scan.Translation().cast<float>(), in_map, {}, surface_in_map);
}

OccupancyPyramid MapOf(const std::vector<test_support::Wall>& walls) {
  OccupancyPyramid map{OccupancyOptions{}};
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Pose2 pose{-1.0 + 0.1 * i, 0.3 * std::sin(0.3 * i), 0.2 * i};
    Draw(PointsFrom(walls, pose, 0.01, 100 + i), pose, &map);
  }
  return map;
}

Eigen::Matrix3d Loose() { return Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal(); }

TEST(GaussNewton, AnalyticGradientIsTheDerivativeOfTheCost) {
  const OccupancyPyramid map = MapOf(test_support::FurnishedRoom());
  const Points points = PointsFrom(test_support::FurnishedRoom(), {0.4, 0.2, 0.3}, 0.01, 1);
  const Pose2 pose{0.43, 0.17, 0.31};
  const auto cost = [&](const Pose2& p) { return EvaluateOccupancyCost(map, 0, points, p, 0.5).cost; };
  const OccupancyCost at = EvaluateOccupancyCost(map, 0, points, pose, 0.5);
  const double step = 2e-4;
  const Eigen::Vector3d numeric(
      (cost({pose.x + step, pose.y, pose.theta}) - cost({pose.x - step, pose.y, pose.theta})) / (2 * step),
      (cost({pose.x, pose.y + step, pose.theta}) - cost({pose.x, pose.y - step, pose.theta})) / (2 * step),
      (cost({pose.x, pose.y, pose.theta + step}) - cost({pose.x, pose.y, pose.theta - step})) / (2 * step));
  EXPECT_LT((at.gradient - numeric).norm(), 0.03 * numeric.norm());
}

TEST(GaussNewton, FindsThePoseToAFractionOfACell) {
  const auto room = test_support::FurnishedRoom();
  const OccupancyPyramid map = MapOf(room);
  double squares = 0.0;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const RandomStream random(5, 2, i);
    const Pose2 truth{random.Uniform(0, -1.0, 2.0), random.Uniform(1, -0.5, 1.5), random.Uniform(2, -3.0, 3.0)};
    const Pose2 start{truth.x + random.Uniform(3, -0.06, 0.06), truth.y + random.Uniform(4, -0.06, 0.06),
                      truth.theta + random.Uniform(5, -0.02, 0.02)};
    const MatchResult match = MatchScan(map, PointsFrom(room, truth, 0.01, 500 + i), start, start, Loose(), {});
    ASSERT_TRUE(match.usable);
    EXPECT_NEAR(match.map_from_scan.theta, truth.theta, 0.006);
    squares += (match.map_from_scan.Translation() - truth.Translation()).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / 40), 0.012);
}

TEST(GaussNewton, ReportsALongEllipseAlongACorridorAndKeepsThePredictionThere) {
  const auto corridor = std::vector<test_support::Wall>{{{-60, -1}, {60, -1}}, {{-60, 1}, {60, 1}}};
  OccupancyPyramid map{OccupancyOptions{}};
  for (int i = 0; i < 30; ++i) {
    const Pose2 pose{0.2 * i, 0.0, 0.0};
    Draw(PointsFrom(corridor, pose, 0.01, static_cast<std::uint32_t>(i)), pose, &map);
  }
  const Pose2 predicted{3.1, 0.03, 0.01};
  const Eigen::Matrix3d prediction = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  const MatchResult match =
      MatchScan(map, PointsFrom(corridor, {3.0, 0, 0}, 0.01, 99), predicted, predicted, prediction, {});
  ASSERT_TRUE(match.usable);
  EXPECT_NEAR(match.map_from_scan.y, 0.0, 0.01);
  EXPECT_NEAR(match.map_from_scan.theta, 0.0, 0.005);
  EXPECT_GT(std::sqrt(match.covariance(0, 0)), 2 * std::sqrt(match.covariance(1, 1)));
}

TEST(CoarseSearch, BringsAPoseFromFarOffIntoTheReachOfGaussNewton) {
  const auto room = test_support::FurnishedRoom();
  const OccupancyPyramid map = MapOf(room);
  const Pose2 truth{0.5, 0.4, 0.8};
  const Points points = PointsFrom(room, truth, 0.01, 3);
  const std::vector<Pose2> modes =
      CoarseSearch(map, points, {truth.x + 0.28, truth.y - 0.22, truth.theta + 0.15}, 0.4, 0.25, {});
  ASSERT_FALSE(modes.empty());
  const MatchResult match = MatchScan(map, points, modes.front(), modes.front(), Loose(), {});
  EXPECT_LT((match.map_from_scan.Translation() - truth.Translation()).norm(), 0.02);
  EXPECT_NEAR(match.map_from_scan.theta, truth.theta, 0.01);
}

TEST(BranchAndBound, EqualsExhaustiveSearch) {
  const auto room = test_support::FurnishedRoom();
  const OccupancyPyramid map = MapOf(room);
  for (const int level : {0, 1}) {
    const SlidingMaximumGrids grids(map, level, 5, 1.0);
    for (std::uint32_t i = 0; i < 12; ++i) {
      const RandomStream random(6, 4, i);
      const Pose2 truth{random.Uniform(0, -1.0, 2.0), random.Uniform(1, -0.5, 1.5), random.Uniform(2, -3.0, 3.0)};
      Points thin;
      ThinAlongScan(PointsFrom(room, truth, 0.02, 700 + i), 0.3, 60, &thin);
      const Pose2 centre{truth.x + random.Uniform(3, -0.8, 0.8), truth.y + random.Uniform(4, -0.8, 0.8),
                         truth.theta + random.Uniform(5, -0.2, 0.2)};
      const SearchWindow window{.half_width_m = 1.0, .half_angle_rad = 0.25, .min_score = i % 3 == 0 ? 0.7 : 0.3};
      const auto fast = BranchAndBound(grids, thin, centre, window);
      const auto slow = ExhaustiveSearch(grids, thin, centre, window);
      ASSERT_EQ(fast.has_value(), slow.has_value());
      if (fast) {
        EXPECT_DOUBLE_EQ(fast->score, slow->score);
      }
    }
  }
}

}  // namespace
}  // namespace survey
