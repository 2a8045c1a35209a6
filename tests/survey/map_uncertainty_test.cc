// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/map_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace survey {
namespace {

// Two poses 40 m apart: one uncertain along x, one in its direction.
TEST(FillSigmas, CarriesTheNearestPosesCovarianceToTheCell) {
  Solution solution;
  solution.scans = {{ScanId{0}, {0, 0, 0}, true}, {ScanId{1}, {40, 0, 1.0}, true}};
  solution.covariances = {{ScanId{0}, Eigen::Vector3d(4e-4, 1e-4, 0).asDiagonal()},
                          {ScanId{1}, Eigen::Vector3d(1e-6, 1e-6, 1e-4).asDiagonal()}};
  SiteRaster raster{.cell_size_m = 0.5, .min_column = -4, .min_row = -4, .width = 100, .height = 40};
  raster.log_odds.assign(100 * 40, 1.0F);
  raster.At(50, 3) = kUnknownLogOdds;
  FillSigmas(solution, &raster);
  const auto sigma_at = [&](double x, double y) {
    const auto cell = raster.CellOf({x, y});
    return raster.sigma_m[raster.Index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))];
  };
  EXPECT_NEAR(sigma_at(3, 12), 0.02, 1e-6);                                    // no rotation: the worst axis
  EXPECT_NEAR(sigma_at(40.25, 10.25), std::hypot(0.01 * 10.25, 0.001), 1e-3);  // 10 m of lever arm
  EXPECT_TRUE(std::isnan(raster.sigma_m[raster.Index(50, 3)]));
}

TEST(FillSigmas, LeavesAMapWithoutCovariancesAlone) {
  SiteRaster raster{.width = 1, .height = 1, .log_odds = {1.0F}};
  FillSigmas({}, &raster);
  EXPECT_TRUE(raster.sigma_m.empty());
}

}  // namespace
}  // namespace survey
