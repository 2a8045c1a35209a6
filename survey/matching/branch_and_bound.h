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
// all shifts in that block. Quantised to bytes. All levels share one array layout with a margin of cells that were
// never observed, so that a search adds bytes at fixed offsets and asks for no borders.
class SlidingMaximumGrids {
 public:
  // Built from one level of a pyramid, for windows up to max_half_width_m.
  SlidingMaximumGrids(const OccupancyPyramid& pyramid, int pyramid_level, int num_levels, double max_half_width_m);

  double cell_size_m() const { return cell_size_m_; }
  int num_levels() const { return static_cast<int>(levels_.size()); }
  int max_shift() const { return max_shift_; }  // cells
  float OccupancyOf(std::uint8_t value) const { return low_ + step_ * static_cast<float>(value); }

  // Whether some shift up to max_shift brings the cell (in cells from the map frame's origin) onto the map.
  bool InReach(int column, int row) const {
    return static_cast<unsigned>(column - min_column_) < static_cast<unsigned>(width_ - 2 * max_shift_) &&
           static_cast<unsigned>(row - min_row_) < static_cast<unsigned>(height_ - 2 * max_shift_);
  }
  // Place of a cell in reach in the arrays, and of its shift by columns and rows relative to it.
  int IndexOf(int column, int row) const {
    return (row - min_row_ + max_shift_) * width_ + column - min_column_ + max_shift_;
  }
  int OffsetOf(int columns, int rows) const { return rows * width_ + columns; }
  const std::uint8_t* Values(int level) const { return levels_[static_cast<std::size_t>(level)].data(); }

 private:
  std::vector<std::uint8_t> Widened(const std::vector<std::uint8_t>& level, int shift) const;

  double cell_size_m_;
  int max_shift_ = 0;
  int min_column_ = 0;  // of the cells in reach
  int min_row_ = 0;
  int width_ = 0;  // of the arrays
  int height_ = 0;
  float low_ = 0.0F;   // occupancy of value 0
  float step_ = 0.0F;  // occupancy of one step
  std::vector<std::vector<std::uint8_t>> levels_;
};

struct SearchWindow {
  double half_width_m = 1.0;  // in x and in y; not more than the grids were built for
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
