// SPDX-License-Identifier: Apache-2.0
#include "survey/stats/reliability.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

// Critical values and non-centrality parameters as printed in textbooks [Baarda68].
TEST(ReliabilityTest, PrintedValues) {
  EXPECT_NEAR(survey::CriticalW(0.001), 3.2905, 1e-4);
  EXPECT_NEAR(survey::CriticalW(0.05), 1.9600, 1e-4);
  EXPECT_NEAR(survey::CriticalT(0.001, 2), 13.8155, 1e-4);
  EXPECT_NEAR(survey::NonCentrality({}, 1), 17.075, 1e-3);
  EXPECT_NEAR(std::sqrt(survey::NonCentrality({}, 1)), 4.132, 1e-3);
  EXPECT_NEAR(survey::NonCentrality({}, 2), 19.66, 0.02);
  EXPECT_NEAR(std::sqrt(survey::NonCentrality({.significance = 0.05, .power = 0.8}, 1)), 2.80, 5e-3);
}

// An uncorrelated observation of deviation s and redundancy r: s * 4.13 / sqrt(r).
TEST(ReliabilityTest, OneDimension) {
  const double s = 0.002, r = 0.25;
  EXPECT_NEAR(survey::MinimalDetectableBias(r / (s * s), survey::NonCentrality({}, 1)), s * 4.132 / std::sqrt(r), 1e-6);
  EXPECT_TRUE(std::isinf(survey::MinimalDetectableBias(0.0, 17.0)));
}

// Two independent coordinates: the worse of both, with the parameter of two dimensions.
TEST(ReliabilityTest, TwoDimensions) {
  const Eigen::Matrix2d covariance = Eigen::Vector2d(4e-6, 9e-6).asDiagonal();
  const Eigen::Matrix2d residual = Eigen::Vector2d(4e-6 * 0.5, 9e-6 * 0.04).asDiagonal();
  const double lambda = survey::NonCentrality({}, 2);
  EXPECT_NEAR(survey::MinimalDetectableBias(covariance, residual, lambda), 0.003 * std::sqrt(lambda / 0.04), 1e-9);
  EXPECT_TRUE(std::isinf(survey::MinimalDetectableBias(covariance, Eigen::Matrix2d::Zero(), lambda)));
}

}  // namespace
