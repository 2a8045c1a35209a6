// SPDX-License-Identifier: Apache-2.0
//
// Exhaustive search of a pose window by branch and bound over precomputed grids [Hess16, section V-B, algorithm 3].
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/grid/occupancy_pyramid.h"

namespace survey {

// Level h holds, for every cell, the maximum over the 2^h x 2^h cells that start at it: an upper bound of the score of
// all shifts in that block. Quantised to bytes; cells outside count as never observed.
class SlidingMaximumGrids {
 public:
  // Built from one level of a pyramid.
  SlidingMaximumGrids(const OccupancyPyramid& pyramid, int pyramid_level, int num_levels);

  double cell_size_m() const { return cell_size_m_; }
  int num_levels() const { return static_cast<int>(levels_.size()); }
  float OccupancyOf(std::uint8_t value) const { return low_ + step_ * static_cast<float>(value); }

  // Value of a cell, in units of cells from the map frame's origin.
  std::uint8_t At(int level, int column, int row) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    const int c = column - grid.min_column;
    const int r = row - grid.min_row;
    if (static_cast<unsigned>(c) >= static_cast<unsigned>(grid.width) ||
        static_cast<unsigned>(r) >= static_cast<unsigned>(grid.height))
      return 0;
    return grid.cells[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(c)];
  }

 private:
  struct Level {
    int min_column = 0;
    int min_row = 0;
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> cells;
  };
  static Level Widened(const Level& level, int shift);

  double cell_size_m_;
  float low_ = 0.0F;   // occupancy of value 0
  float step_ = 0.0F;  // occupancy of one step
  std::vector<Level> levels_;
};

struct SearchWindow {
  double half_width_m = 1.0;  // in x and in y
  double half_angle_rad = 0.3;
  double min_score = 0.0;  // mean occupancy that a result must exceed
};

struct SearchResult {
  Pose2 map_from_scan;
  double score = 0.0;  // mean occupancy, 0..1
};

// The pose of best score on the search grid (steps: one cell, and the angle that moves the farthest point by one cell)
// around `centre`; empty when none exceeds min_score. Ties go to the pose found first in a fixed order.
std::optional<SearchResult> BranchAndBound(const SlidingMaximumGrids& grids,
                                           std::span<const Eigen::Vector2f> points_in_scan, const Pose2& centre,
                                           const SearchWindow& window);

// The same by trying every pose: the second method of the tests.
std::optional<SearchResult> ExhaustiveSearch(const SlidingMaximumGrids& grids,
                                             std::span<const Eigen::Vector2f> points_in_scan, const Pose2& centre,
                                             const SearchWindow& window);

}  // namespace survey
