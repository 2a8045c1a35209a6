// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/occupancy_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "survey/grid/line_cells.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Points = std::vector<Eigen::Vector2f>;

double Odds(double p) { return p / (1.0 - p); }

TEST(OccupancyPyramid, FollowsTheOddsUpdateWithClamping) {
  const OccupancyOptions options;
  OccupancyPyramid grid(options);
  const Points hit = {{1.025F, 0.025F}};
  double odds = 1.0;
  for (int i = 0; i < 40; ++i) {
    grid.Insert({0.025F, 0.025F}, hit, {});
    odds = std::min(odds * Odds(options.p_hit), Odds(options.p_max));
    EXPECT_NEAR(grid.Occupancy(0, 1.025F, 0.025F), odds / (1.0 + odds), 4e-3)
        << i;  // log-odds are kept in steps of 0.01
  }
  EXPECT_NEAR(grid.Occupancy(0, 1.025F, 0.025F), options.p_max, 2e-3);
  EXPECT_NEAR(grid.Occupancy(0, 0.525F, 0.025F), options.p_min, 2e-3);
  EXPECT_EQ(grid.At(0, 30, 30), OccupancyPyramid::kUnknown);
}

TEST(OccupancyPyramid, CountsEveryCellOncePerScanAndHitsBeforeMisses) {
  OccupancyPyramid grid(OccupancyOptions{});
  // Ten rays through the cell that the first one hits.
  Points hits = {{1.025F, 0.025F}};
  for (int i = 0; i < 10; ++i) hits.emplace_back(2.025F, 0.025F);
  grid.Insert({0.025F, 0.025F}, hits, {});
  EXPECT_NEAR(grid.Occupancy(0, 1.025F, 0.025F), 0.6, 2e-3);
  EXPECT_NEAR(grid.Occupancy(0, 0.525F, 0.025F), 0.45, 2e-3);
  EXPECT_NEAR(grid.Occupancy(0, 2.025F, 0.025F), 0.6, 2e-3);
}

TEST(OccupancyPyramid, EveryCoarseCellIsTheMaximumOfItsChildren) {
  OccupancyPyramid grid(OccupancyOptions{});
  for (std::uint64_t scan = 0; scan < 60; ++scan) {
    const RandomStream random(7, 1, static_cast<std::uint32_t>(scan));
    Points hits;
    for (std::uint64_t i = 0; i < 40; ++i) {
      hits.emplace_back(static_cast<float>(20.0 * random.Uniform(2 * i) - 12.0),
                        static_cast<float>(20.0 * random.Uniform(2 * i + 1) - 5.0));
    }
    const Eigen::Vector2f origin(static_cast<float>(0.05 * static_cast<double>(scan)), 0.3F);
    grid.Insert(origin, hits, {});
  }
  for (int level = 1; level < grid.num_levels(); ++level) {
    const OccupancyPyramid::Extent extent = grid.ExtentOf(level);
    for (int row = extent.min_row; row < extent.min_row + extent.height; ++row) {
      for (int column = extent.min_column; column < extent.min_column + extent.width; ++column) {
        OccupancyPyramid::Evidence highest = 0;
        for (const int dx : {0, 1}) {
          for (const int dy : {0, 1}) highest = std::max(highest, grid.At(level - 1, 2 * column + dx, 2 * row + dy));
        }
        ASSERT_EQ(grid.At(level, column, row), highest) << level << " " << column << " " << row;
      }
    }
  }
}

TEST(OccupancyPyramid, InterpolationMeetsTheCentresAndItsGradientIsTheDerivative) {
  OccupancyPyramid grid(OccupancyOptions{});
  grid.Insert({0.0F, 0.0F}, Points{{1.02F, 0.51F}, {1.03F, 0.57F}, {0.97F, 0.62F}}, {});
  EXPECT_NEAR(grid.Interpolate(0, 1.025F, 0.525F).value, grid.Occupancy(0, 1.025F, 0.525F), 1e-5);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const RandomStream random(3, 2, static_cast<std::uint32_t>(i));
    const auto x = static_cast<float>(0.9 + 0.2 * random.Uniform(0));
    const auto y = static_cast<float>(0.4 + 0.3 * random.Uniform(1));
    constexpr float kStep = 1e-3F;
    // Away from the kinks at cell centres.
    const float fraction_x = std::abs(std::remainder(x - 0.025F, 0.05F));
    const float fraction_y = std::abs(std::remainder(y - 0.025F, 0.05F));
    if (fraction_x < 2 * kStep || fraction_y < 2 * kStep) continue;
    const InterpolatedOccupancy m = grid.Interpolate(0, x, y);
    EXPECT_NEAR(m.d_dx,
                (grid.Interpolate(0, x + kStep, y).value - grid.Interpolate(0, x - kStep, y).value) / (2 * kStep),
                2e-2);
    EXPECT_NEAR(m.d_dy,
                (grid.Interpolate(0, x, y + kStep).value - grid.Interpolate(0, x, y - kStep).value) / (2 * kStep),
                2e-2);
  }
}

TEST(LineCells, VisitsAConnectedChainOfCellsThatTheSegmentCrosses) {
  for (std::uint64_t i = 0; i < 500; ++i) {
    const RandomStream random(11, 3, static_cast<std::uint32_t>(i));
    const auto coordinate = [&](std::uint64_t k) { return static_cast<float>(40.0 * random.Uniform(k) - 20.0); };
    const Eigen::Vector2f begin(coordinate(0), coordinate(1));
    const Eigen::Vector2f end(coordinate(2), coordinate(3));
    std::vector<Eigen::Vector2i> cells;
    ForEachCellOnLine(begin, end, [&](int column, int row) { cells.emplace_back(column, row); });
    cells.emplace_back(static_cast<int>(std::floor(end.x())), static_cast<int>(std::floor(end.y())));
    EXPECT_EQ(cells.front(),
              Eigen::Vector2i(static_cast<int>(std::floor(begin.x())), static_cast<int>(std::floor(begin.y()))));
    const Eigen::Vector2f direction = (end - begin).normalized();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (k > 0) {
        ASSERT_EQ((cells[k] - cells[k - 1]).lpNorm<1>(), 1);
      }
      const Eigen::Vector2f centre = cells[k].cast<float>() + Eigen::Vector2f(0.5F, 0.5F);
      const Eigen::Vector2f offset = centre - begin;
      EXPECT_LT(std::abs(offset.x() * direction.y() - offset.y() * direction.x()), 0.7072F);
    }
  }
}

}  // namespace
}  // namespace survey
