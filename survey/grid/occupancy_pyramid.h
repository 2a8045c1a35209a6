// SPDX-License-Identifier: Apache-2.0
//
// Multi-resolution occupancy grid ([CN] section 2.1 and eq. 1, [Hess16] eq. 3). Level 0 holds the log-odds of every
// cell; each cell of a coarser level holds the maximum of its four children, so that all levels are consistent after
// every scan. Frame: whatever frame the caller's points are in, metres. Cell (i, j) of level 0 covers [i s, (i+1) s) x
// [j s, (j+1) s); its value stands at its centre. The grid grows when a scan leaves it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "survey/grid/cell_bits.h"
#include "survey/grid/ray_fan.h"

namespace survey {

struct OccupancyOptions {
  double cell_size_m = 0.05;
  int num_levels = 4;
  double p_hit = 0.6;    // occupancy that one end point alone gives to a fresh cell
  double p_miss = 0.45;  // occupancy that one ray through it alone gives
  double p_min = 0.12;   // clamping, [CN] eq. (1)
  double p_max = 0.97;
};

// Occupancy with its gradient (1/m), interpolated between four cell centres: [CN] eq. (6)-(7), [Hector11].
struct InterpolatedOccupancy {
  float value = 0.0F;
  float d_dx = 0.0F;
  float d_dy = 0.0F;
};

// Columns first ... last, both included; without arguments none.
struct ColumnSpan {
  int first = std::numeric_limits<int>::max();
  int last = -1;

  bool empty() const { return last < first; }
};

class OccupancyPyramid {
 public:
  // Evidence of a cell: 0 = never observed, otherwise 1 + quantised log-odds above the lower clamp.
  using Evidence = std::uint16_t;
  static constexpr Evidence kUnknown = 0;

  explicit OccupancyPyramid(const OccupancyOptions& options);

  // Enters one scan, [CN] section 2.1: every cell that holds an end point in `hits` becomes more occupied, every cell
  // on the line from `origin` to an end point in `hits` or `free_ends` less, each at most once; hits take precedence.
  // `surface` holds further occupied points between the hits, without rays of their own (see SurfacePoints).
  void Insert(const Eigen::Vector2f& origin, std::span<const Eigen::Vector2f> hits,
              std::span<const Eigen::Vector2f> free_ends, std::span<const Eigen::Vector2f> surface = {});

  int num_levels() const { return static_cast<int>(levels_.size()); }
  double cell_size_m(int level = 0) const { return options_.cell_size_m * (1 << level); }

  // Occupancy of the cell that holds the point; p_min where never observed or outside.
  float Occupancy(int level, float x, float y) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    const int column = static_cast<int>(std::floor(x * grid.cells_per_m)) - grid.min_column;
    const int row = static_cast<int>(std::floor(y * grid.cells_per_m)) - grid.min_row;
    return occupancy_of_[grid.At(column, row)];
  }

  InterpolatedOccupancy Interpolate(int level, float x, float y) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    const float u = x * grid.cells_per_m - 0.5F;
    const float v = y * grid.cells_per_m - 0.5F;
    const float u0 = std::floor(u);
    const float v0 = std::floor(v);
    const int column = static_cast<int>(u0) - grid.min_column;
    const int row = static_cast<int>(v0) - grid.min_row;
    if (column < 0 || row < 0 || column + 1 >= grid.width || row + 1 >= grid.height)
      return {occupancy_of_[kUnknown], 0, 0};
    const Evidence* lower = &grid.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) +
                                        static_cast<std::size_t>(column)];
    const Evidence* upper = lower + grid.width;
    const float fu = u - u0;
    const float fv = v - v0;
    const float m00 = occupancy_of_[lower[0]];
    const float m10 = occupancy_of_[lower[1]];
    const float m01 = occupancy_of_[upper[0]];
    const float m11 = occupancy_of_[upper[1]];
    const float below = m00 + fu * (m10 - m00);
    const float above = m01 + fu * (m11 - m01);
    return {below + fv * (above - below), ((1 - fv) * (m10 - m00) + fv * (m11 - m01)) * grid.cells_per_m,
            (above - below) * grid.cells_per_m};
  }

  // Raw access for searches: evidence of a cell by its column and row in units of the level's cells from the frame's
  // origin.
  Evidence At(int level, int column, int row) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    return grid.At(column - grid.min_column, row - grid.min_row);
  }
  // A whole row of a level, which must exist.
  std::span<const Evidence> Row(int level, int row) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    const auto width = static_cast<std::size_t>(grid.width);
    return std::span(grid.cells).subspan(static_cast<std::size_t>(row - grid.min_row) * width, width);
  }
  float OccupancyOf(Evidence evidence) const { return occupancy_of_[evidence]; }
  float LogOddsOf(Evidence evidence) const;  // NaN for unknown

  // Cells of a level that exist: [min, min + size).
  struct Extent {
    int min_column = 0;
    int min_row = 0;
    int width = 0;
    int height = 0;
  };
  Extent ExtentOf(int level) const {
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    return {grid.min_column, grid.min_row, grid.width, grid.height};
  }

 private:
  struct Level {
    float cells_per_m = 0.0F;
    int min_column = 0;
    int min_row = 0;
    int width = 0;
    int height = 0;
    std::vector<Evidence> cells;

    Evidence At(int column, int row) const {
      if (column < 0 || row < 0 || column >= width || row >= height) return kUnknown;
      return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
    }
    Evidence* RowBegin(int row) {
      return cells.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    }
    // Place in the array, in cells.
    double ColumnOf(float x) const { return static_cast<double>(x * cells_per_m) - min_column; }
    double RowOf(float y) const { return static_cast<double>(y * cells_per_m) - min_row; }
  };

  void GrowToHold(const Eigen::Vector2f& low, const Eigen::Vector2f& high);
  void UpdateRow(int row);  // of the scan that is being inserted; rows of the array
  void UpdateCoarseLevels(int low_row, int high_row);

  OccupancyOptions options_;
  std::int16_t hit_step_ = 0;
  std::int16_t miss_step_ = 0;
  std::int16_t prior_ = 0;  // evidence of p = 0.5
  std::int16_t max_evidence_ = 0;
  std::vector<float> occupancy_of_;  // by evidence
  std::vector<Level> levels_;
  // Of the scan that is being inserted; kept for their memory.
  RayFan fan_;
  CellBits missed_;
  CellBits hit_;
  std::vector<ColumnSpan> touched_;  // by row
};

}  // namespace survey
