// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/place_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace survey {
namespace {

// Two poses left and right of a place, sure but for their headings: what both turn alike cancels in the middle.
TEST(PlaceCovariance, BetweenTwoPoses) {
  constexpr double kHeading = 0.001;
  Solution solution;
  solution.scans = {{ScanId{0}, {-4, 0, 0}, true}, {ScanId{1}, {4, 0, 1.0}, true}};
  const Eigen::Matrix3d covariance = Eigen::Vector3d(4e-6, 4e-6, kHeading * kHeading).asDiagonal();
  EXPECT_FALSE(PlaceCovariance({0, 0}, solution));
  solution.covariances = {{ScanId{0}, covariance}};
  EXPECT_NEAR((*PlaceCovariance({0, 0}, solution))(1, 1), 4e-6 + std::pow(4 * kHeading, 2), 1e-12);
  solution.covariances.push_back({ScanId{1}, covariance});
  const double alike = std::exp(-8.0 / 30.0);
  const Eigen::Matrix2d between = *PlaceCovariance({0, 0}, solution);
  EXPECT_NEAR(between(0, 0), 4e-6 * (1 + alike) / 2, 1e-12);
  EXPECT_NEAR(between(1, 1), 4e-6 * (1 + alike) / 2 + std::pow(4 * kHeading, 2) * (1 - alike) / 2, 1e-12);
  EXPECT_NEAR(between(0, 1), 0.0, 1e-12);
}

// However many poses stand at one place, they know it no better than one.
TEST(PlaceCovariance, OfPosesThatErrAlike) {
  Solution solution;
  Eigen::Matrix3d covariance;
  covariance << 4e-6, 1e-6, 1e-7, 1e-6, 2e-6, 0, 1e-7, 0, 1e-6;
  Eigen::Matrix<double, 2, 3> carried;
  carried << 1, 0, -3, 0, 1, 10;
  for (int i = 0; i < 100; ++i) {
    solution.scans.push_back({ScanId{i}, {500000, 5600000, 0.1 * i}, true});
    solution.covariances.push_back({ScanId{i}, covariance});
    const Eigen::Matrix2d at = *PlaceCovariance({500010, 5600003}, solution);
    EXPECT_TRUE(at.isApprox(carried * covariance * carried.transpose(), 1e-9)) << i;
  }
}

}  // namespace
}  // namespace survey
