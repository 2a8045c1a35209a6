// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/surface_match.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "survey/sensors/scan_points.h"
#include "survey/stats/philox.h"
#include "tests/support/room.h"

namespace survey {
namespace {

using Walls = std::vector<test_support::Wall>;

std::vector<SurfacePoint> PointsFrom(const Walls& walls, const Pose2& pose, double sigma_m, std::uint32_t seed) {
  const ScanGeometry geometry = test_support::WideScanner(541);
  const ScanProjector projector(std::vector{geometry}, 30.0, 0.0);
  ScanPoints points;
  projector.Project(0, test_support::SimulateRanges(walls, pose, geometry, sigma_m, seed), {}, &points);
  std::vector<SurfacePoint> surfaces;
  SurfacePointsOfScan(points.hits, 0.05, 250, &surfaces);
  return surfaces;
}

struct Maps {
  SurfaceMap fine{0.1};
  SurfaceMap coarse{0.4};
  void Insert(const Pose2& pose, const std::vector<SurfacePoint>& points) {
    fine.Insert(pose, points);
    coarse.Insert(pose, points);
  }
};

Maps MapsOf(const Walls& walls, double sigma_m = 0.01) {
  Maps maps;
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Pose2 pose{-1.0 + 0.1 * i, 0.3 * std::sin(0.3 * i), 0.2 * i};
    maps.Insert(pose, PointsFrom(walls, pose, sigma_m, 100 + i));
  }
  return maps;
}

MatchResult Match(const Maps& maps, const std::vector<SurfacePoint>& points, const Pose2& start,
                  const Eigen::Matrix3d& prediction) {
  return MatchToSurfaces(&maps.coarse, maps.fine, points, start, start, prediction, {});
}

Eigen::Matrix3d Loose() { return Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal(); }

TEST(SurfacePoints, NormalsOfAWallPointAcrossItToTheLidarAndEdgesHaveNone) {
  const Walls walls = {{{-5, 2}, {1, 2}}, {{1, 2}, {1, 5}}};
  const std::vector<SurfacePoint> points = PointsFrom(walls, {}, 0.003, 1);
  ASSERT_GT(points.size(), 50U);
  int with_normal = 0;
  for (const SurfacePoint& point : points) {
    if (point.normal.isZero()) continue;
    ++with_normal;
    EXPECT_LT(point.normal.dot(point.position), 0.0F);
    if (point.position.x() < 0.5F) {
      EXPECT_GT(-point.normal.y(), 0.995F);
    }
  }
  EXPECT_GT(with_normal, static_cast<int>(points.size()) * 8 / 10);
  EXPECT_TRUE(points.back().normal.isZero() || points.back().position.x() < 0.7F);  // the edge behind which beams pass
}

TEST(SurfaceMap, KeepsTheTwoFacesOfAThinWallApart) {
  SurfaceMap map(0.1);
  map.Insert({}, std::vector<SurfacePoint>{{{1.01F, 0.05F}, {-1, 0}}, {{1.07F, 0.05F}, {1, 0}}});
  const Surfel* near_face = map.Nearest({1.04F, 0.05F}, {-1, 0});
  const Surfel* far_face = map.Nearest({1.04F, 0.05F}, {1, 0});
  ASSERT_NE(near_face, nullptr);
  ASSERT_NE(far_face, nullptr);
  EXPECT_FLOAT_EQ(near_face->mean.x(), 1.01F);
  EXPECT_FLOAT_EQ(far_face->mean.x(), 1.07F);
  EXPECT_EQ(map.Nearest({1.5F, 0.05F}, {-1, 0}), nullptr);
}

TEST(SurfaceMatch, FindsThePoseToMillimetresAndItsCovarianceIsOfThatSize) {
  const Walls room = test_support::FurnishedRoom();
  const Maps maps = MapsOf(room);
  constexpr int kTrials = 60;
  double squares = 0.0;
  double nees = 0.0;
  for (std::uint32_t i = 0; i < kTrials; ++i) {
    const RandomStream random(5, 2, i);
    const Pose2 truth{random.Uniform(0, -1.0, 2.0), random.Uniform(1, -0.5, 1.5), random.Uniform(2, -3.0, 3.0)};
    const Pose2 start{truth.x + random.Uniform(3, -0.15, 0.15), truth.y + random.Uniform(4, -0.15, 0.15),
                      truth.theta + random.Uniform(5, -0.05, 0.05)};
    const MatchResult match = Match(maps, PointsFrom(room, truth, 0.01, 500 + i), start, Loose());
    ASSERT_TRUE(match.usable);
    EXPECT_GT(match.score, 0.9);
    Eigen::Vector3d error = match.map_from_scan.Vector() - truth.Vector();
    error.z() = NormalizeAngle(error.z());
    squares += error.head<2>().squaredNorm();
    nees += error.dot(match.covariance.inverse() * error) / 3.0;
  }
  EXPECT_LT(std::sqrt(squares / kTrials), 0.004);
  // Conservative, for a real map bends and a wall is rough; but not by more than an order of magnitude in variance.
  EXPECT_LT(nees / kTrials, 1.5);
  EXPECT_GT(nees / kTrials, 0.05);
}

TEST(SurfaceMatch, IsNotLedAstrayBySomebodyInTheWay) {
  const Walls room = test_support::FurnishedRoom();
  const Maps maps = MapsOf(room);
  const Pose2 truth{0.5, 0.4, 0.8};
  std::vector<SurfacePoint> points = PointsFrom(room, truth, 0.01, 3);
  for (std::size_t i = 0; i < points.size() / 4; ++i) {  // somebody stands in the way of a quarter of the beams
    points[i].position *= 0.4F;
    points[i].normal.setZero();
  }
  const MatchResult match = Match(maps, points, {0.55, 0.35, 0.81}, Loose());
  ASSERT_TRUE(match.usable);
  EXPECT_LT((match.map_from_scan.Translation() - truth.Translation()).norm(), 0.01);
}

TEST(SurfaceMatch, ReportsALongEllipseAlongACorridorAndKeepsThePredictionThere) {
  const Walls corridor = {{{-60, -1}, {60, -1}}, {{-60, 1}, {60, 1}}};
  Maps maps;
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Pose2 pose{0.2 * i, 0.0, 0.0};
    maps.Insert(pose, PointsFrom(corridor, pose, 0.01, i));
  }
  const Pose2 predicted{3.1, 0.03, 0.01};
  const Eigen::Matrix3d prediction = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
  const MatchResult match = Match(maps, PointsFrom(corridor, {3.0, 0, 0}, 0.01, 99), predicted, prediction);
  ASSERT_TRUE(match.usable);
  EXPECT_NEAR(match.map_from_scan.x, predicted.x, 0.05);
  EXPECT_NEAR(match.map_from_scan.y, 0.0, 0.005);
  EXPECT_NEAR(match.map_from_scan.theta, 0.0, 0.003);
  EXPECT_GT(std::sqrt(match.covariance(0, 0)), 10 * std::sqrt(match.covariance(1, 1)));
}

TEST(SurfaceMatch, SearchBringsAPoseFromFarOffIntoReach) {
  const Walls room = test_support::FurnishedRoom();
  const Maps maps = MapsOf(room);
  const Pose2 truth{0.5, 0.4, 0.8};
  const std::vector<SurfacePoint> points = PointsFrom(room, truth, 0.01, 3);
  const std::vector<Pose2> modes =
      SearchSurfaces(maps.fine, points, {truth.x + 0.7, truth.y - 0.6, truth.theta + 0.3}, 0.8, 0.4);
  ASSERT_FALSE(modes.empty());
  const MatchResult match = Match(maps, points, modes.front(), Loose());
  EXPECT_LT((match.map_from_scan.Translation() - truth.Translation()).norm(), 0.01);
}

}  // namespace
}  // namespace survey
