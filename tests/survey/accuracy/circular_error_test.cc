// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/circular_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/geometry/pose2.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

const Eigen::Vector2d kZero = Eigen::Vector2d::Zero();

Eigen::Matrix2d Ellipse(double sigma_u, double sigma_v, double angle_rad) {
  const Eigen::Matrix2d turn = Rotation2(angle_rad);
  return turn * Eigen::Vector2d(sigma_u * sigma_u, sigma_v * sigma_v).asDiagonal() * turn.transpose();
}

TEST(CircularErrorTest, CircleIsRayleigh) {
  for (const double p : {0.394, 0.5, 0.95, 0.999}) {
    EXPECT_NEAR(CircularError(p, kZero, Ellipse(0.03, 0.03, 0)), 0.03 * std::sqrt(-2 * std::log1p(-p)), 1e-8) << p;
  }
}

TEST(CircularErrorTest, LineIsNormal) { EXPECT_NEAR(CircularError(0.95, kZero, Ellipse(2, 0, 1)), 2 * 1.959964, 1e-5); }

// Exact values for sigma ratios 1, 0.8, 0.6, 0.4, 0.2, as printed in the literature on circular errors.
TEST(CircularErrorTest, EllipsesAgreeWithPublishedFactors) {
  const double factors[][2] = {{1.0, 2.448}, {0.8, 2.230}, {0.6, 2.081}, {0.4, 2.005}, {0.2, 1.970}};
  for (const auto& [ratio, factor] : factors) {
    EXPECT_NEAR(CircularError(0.95, kZero, Ellipse(1, ratio, 0.7)), factor, 6e-4) << ratio;
  }
}

TEST(CircularErrorTest, NoSpreadLeavesTheMean) {
  EXPECT_NEAR(CircularError(0.95, {0.3, 0.4}, Eigen::Matrix2d::Zero()), 0.5, 1e-6);
  EXPECT_EQ(CircularError(0.95, kZero, Eigen::Matrix2d::Zero()), 0.0);
}

// Second method: counting random errors with a mean and a turned ellipse.
TEST(CircularErrorTest, AgreesWithCounting) {
  const Eigen::Vector2d mean(0.02, -0.05);
  const Eigen::Matrix2d turn = Rotation2(0.5);
  const double radius = CircularError(0.95, mean, Ellipse(0.06, 0.01, 0.5));
  const RandomStream random(1, 0, 0);
  const int count = 200000;
  int within = 0;
  for (int i = 0; i < count; ++i) {
    const auto [u, v] = random.Normals(static_cast<std::uint64_t>(i));
    if ((mean + turn * Eigen::Vector2d(0.06 * u, 0.01 * v)).norm() <= radius) ++within;
  }
  EXPECT_NEAR(static_cast<double>(within) / count, 0.95, 0.002);  // four sigmas of the count
}

}  // namespace
}  // namespace survey
