// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/map_uncertainty.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

// Two poses 40 m apart: one uncertain along x, one in its direction.
TEST(WithSigmas, CarriesTheNearestPosesCovarianceToTheCell) {
  Solution solution;
  solution.scans = {{ScanId{0}, {0, 0, 0}, true}, {ScanId{1}, {40, 0, 1.0}, true}};
  solution.covariances = {{ScanId{0}, Eigen::Vector3d(4e-4, 1e-4, 0).asDiagonal()},
                          {ScanId{1}, Eigen::Vector3d(1e-6, 1e-6, 1e-4).asDiagonal()}};
  SiteRaster raster{.cell_size_m = 0.5, .min_column = -4, .min_row = -4, .width = 100, .height = 40};
  raster.log_odds.assign(100 * 40, 1.0F);
  raster.At(50, 3) = kUnknownLogOdds;
  raster = WholeOf(WithSigmas(StripsOf(raster), solution));
  const auto sigma_at = [&](double x, double y) {
    const auto cell = raster.CellOf({x, y});
    return raster.sigma_m[raster.Index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))];
  };
  EXPECT_NEAR(sigma_at(3, 12), 0.02, 1e-6);                                    // no rotation: the worst axis
  EXPECT_NEAR(sigma_at(40.25, 10.25), std::hypot(0.01 * 10.25, 0.001), 1e-3);  // 10 m of lever arm
  EXPECT_TRUE(std::isnan(raster.sigma_m[raster.Index(50, 3)]));
}

// Strips of any height give the same cells.
TEST(WithSigmas, DoNotDependOnTheStrips) {
  Solution solution;
  for (int i = 0; i < 6; ++i) {
    solution.scans.push_back({ScanId{i}, {2.0 * i, 1.0 * i, 0.1 * i}, true});
    solution.covariances.push_back({ScanId{i}, Eigen::Vector3d(1e-4, 2e-4, 1e-5 * (i + 1)).asDiagonal()});
  }
  SiteRaster raster{.cell_size_m = 0.05, .min_column = -7, .min_row = 3, .width = 97, .height = 61};
  for (int i = 0; i < 97 * 61; ++i) raster.log_odds.push_back(i % 5 == 0 ? kUnknownLogOdds : 1.0F);
  const RasterStrips strips = WithSigmas(StripsOf(raster), solution);
  const SiteRaster whole = WholeOf(strips);
  for (int first = 0; first < 61; first += 7) {
    const SiteRaster rows = strips.read(3 + first, std::min(7, 61 - first));
    for (std::size_t i = 0; i < rows.sigma_m.size(); ++i) {
      const float expected = whole.sigma_m[whole.Index(0, first) + i];
      EXPECT_TRUE(rows.sigma_m[i] == expected || (std::isnan(rows.sigma_m[i]) && std::isnan(expected))) << first;
    }
  }
}

TEST(WithSigmas, LeavesAMapWithoutCovariancesAlone) {
  const SiteRaster raster{.width = 1, .height = 1, .log_odds = {1.0F}};
  const RasterStrips strips = WithSigmas(StripsOf(raster), {});
  EXPECT_FALSE(strips.has_sigma);
  EXPECT_TRUE(WholeOf(strips).sigma_m.empty());
}

}  // namespace
}  // namespace survey
