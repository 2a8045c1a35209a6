// SPDX-License-Identifier: Apache-2.0
#include "survey/control/site_tie.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "survey/control/coordinate_reduction.h"

namespace {

using survey::SiteTie;
using survey::TiePoint;

constexpr double kTurn = 0.3;

// A grid turned by 0.3 rad, scaled by 0.9997, far away.
std::vector<TiePoint> TiePoints(double scale) {
  std::vector<TiePoint> points;
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{0, 0}, {100, 10}, {80, 90}, {-5, 60}}) {
    const Eigen::Vector2d grid(x, y);
    const Eigen::Rotation2Dd turn(kTurn);
    points.push_back({"T", grid, Eigen::Vector2d(690000, 5334000) + scale * (turn * grid)});
  }
  return points;
}

TEST(SiteTieTest, FindsTheTransformation) {
  const SiteTie tie = FitSiteTie(TiePoints(0.9997), true);
  ASSERT_TRUE(tie.usable);
  EXPECT_NEAR(tie.rotation, kTurn, 1e-9);
  EXPECT_NEAR(tie.scale, 0.9997, 1e-9);
  EXPECT_LT(tie.sigma_zero, 1e-8);
  EXPECT_EQ(tie.degrees_of_freedom, 4);
  const Eigen::Vector2d in_grid(12, 34);
  EXPECT_LT(
      (tie.Apply(in_grid) - Eigen::Vector2d(690000, 5334000) - 0.9997 * (Eigen::Rotation2Dd(kTurn) * in_grid)).norm(),
      1e-8);
}

// Without scale the misfit stays in the residuals: 0.3 per mille of the distance from the centre.
TEST(SiteTieTest, ThreeParametersKeepTheScale) {
  const std::vector<TiePoint> points = TiePoints(0.9997);
  const SiteTie tie = FitSiteTie(points, false);
  ASSERT_TRUE(tie.usable);
  EXPECT_EQ(tie.scale, 1.0);
  EXPECT_NEAR(tie.fitted_scale, 0.9997, 1e-9);
  EXPECT_EQ(tie.degrees_of_freedom, 5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(tie.residuals[i].norm(), 0.0003 * (points[i].in_grid - tie.grid_origin).norm(), 1e-8);
  }
}

TEST(SiteTieTest, RefusesWhatIsNoTie) {
  std::vector<TiePoint> points = TiePoints(1.0);
  EXPECT_FALSE(survey::FitSiteTie({points[0]}, false).usable);
  EXPECT_FALSE(survey::FitSiteTie({points[0], points[0]}, false).usable);
  for (TiePoint& point : points) std::swap(point.in_grid.x(), point.in_grid.y());
  const SiteTie exchanged = FitSiteTie(points, true);
  EXPECT_FALSE(exchanged.usable);
  EXPECT_NE(exchanged.message.find("the axes of one system are exchanged"), std::string::npos);
}

TEST(CoordinateReductionTest, CovariancesTurnWithTheGrid) {
  survey::ControlNetwork network;
  network.points = {
      {.name = "A", .position_in_site = {0, 0}, .covariance = Eigen::Vector2d(4e-6, 1e-6).asDiagonal()},
      {.name = "B", .position_in_site = {100, 10}, .covariance = Eigen::Vector2d(4e-6, 1e-6).asDiagonal()},
      {.name = "T", .role = survey::PointRole::kTie}};
  network.correlations = {{0, 1, Eigen::Matrix2d{{2e-6, 0}, {0, 0}}}};
  const std::vector<TiePoint> points = TiePoints(1.0);
  ApplySiteTie(FitSiteTie(points, true), points, &network);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(kTurn).toRotationMatrix();
  EXPECT_LT((network.points[1].position_in_site - points[1].in_projected).norm(), 1e-8);
  EXPECT_LT((network.points[0].covariance - turn * Eigen::Vector2d(4e-6, 1e-6).asDiagonal() * turn.transpose()).norm(),
            1e-14);
  EXPECT_LT((network.correlations[0].covariance - turn * Eigen::Matrix2d{{2e-6, 0}, {0, 0}} * turn.transpose()).norm(),
            1e-14);
  EXPECT_TRUE(network.points[2].position_in_site.isZero(0.0)) << "a place known by name only";
  EXPECT_EQ(network.remarks.size(), 5U);
}

TEST(CoordinateReductionTest, GroundToGrid) {
  survey::ControlNetwork network;
  network.points = {{.name = "A", .position_in_site = {1100, 2000}, .covariance = Eigen::Matrix2d::Identity() * 1e-6}};
  ReduceToGrid(0.9996, {1000, 2000}, &network);
  EXPECT_LT((network.points[0].position_in_site - Eigen::Vector2d(1099.96, 2000)).norm(), 1e-9);
  EXPECT_NE(network.remarks.at(0).find("combined factor 0.99960000"), std::string::npos) << network.remarks[0];
}

}  // namespace
