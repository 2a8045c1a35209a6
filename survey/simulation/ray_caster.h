// SPDX-License-Identifier: Apache-2.0
//
// Nearest hit of a ray among the shapes of a floor plan, by a walk through a uniform grid of cells that hold their own
// copies of the shapes ([Amanatides87]). Plan frame, metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "survey/simulation/floor_plan.h"

namespace survey {

// Range of a ray that meets nothing.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

struct PaneHit {
  double range_m;
  double response;
};

struct RayHit {
  double range_m = kNever;  // to the nearest opaque shape; infinity: none in reach
  int num_panes = 0;        // panes before it, nearest first (at most four are kept)
  std::array<PaneHit, 4> panes;
};

class RayCaster {
 public:
  explicit RayCaster(const FloorPlan& plan);

  // `direction` is a unit vector. Shapes farther than `reach_m` are not seen.
  RayHit Cast(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double reach_m) const;

  // Distance from a point to the nearest shape (panes included), up to `reach_m`; 0 inside a disc.
  double Clearance(const Eigen::Vector2d& position, double reach_m) const;

 private:
  struct Segment {
    Eigen::Vector2d a;
    Eigen::Vector2d d;  // b - a
  };
  struct PaneSegment {
    Segment segment;
    double response;
  };
  // Where a cell's shapes begin in each list; the next cell's beginning is the end.
  struct Cell {
    std::uint32_t segments = 0;
    std::uint32_t discs = 0;
    std::uint32_t panes = 0;
  };

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
  }
  // Columns and rows of the cells around a point, clamped to the grid: {first column, first row, last column, last row}
  std::array<int, 4> CellsAround(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;
  void HitCell(const Cell& cell, const Cell& next, const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
               RayHit* hit) const;

  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();  // of cell (0, 0)
  int width_ = 0;
  int height_ = 0;
  std::vector<Cell> cells_;  // one more than there are cells
  std::vector<Segment> segments_;
  std::vector<Disc> discs_;
  std::vector<PaneSegment> panes_;
};

// Range at which a ray (unit direction) enters a disc; infinity when it misses or begins inside.
double RangeToDisc(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, const Disc& disc);

}  // namespace survey
