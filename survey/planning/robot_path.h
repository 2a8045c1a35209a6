// SPDX-License-Identifier: Apache-2.0
//
// Whether a robot of a given radius gets from one place to another on a map, and how ([AS] figure 12: the same goal
// before and after an area was forbidden). Shortest way over the cells by A* [Hart68], steps to eight neighbours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

struct RobotOptions {
  double radius_m = 0.3;               // the robot keeps at least this from walls, unknown cells and forbidden areas
  float occupied_probability = 0.65F;  // cells from here on are walls
};

// Where a robot may be. Cells that were never observed are as walls.
class RobotSpace {
 public:
  RobotSpace(const SiteRaster& map, const RobotOptions& options);

  // Distance from the cell of a place to the nearest cell that the robot must not touch (m); 0 in such cells and
  // outside of the map.
  double ClearanceAt(const Eigen::Vector2d& place) const;

  // Cell centres from start to goal; empty when there is no way, or one of the two has not the clearance.
  std::vector<Eigen::Vector2d> Path(const Eigen::Vector2d& start, const Eigen::Vector2d& goal) const;

 private:
  bool IsOpen(std::size_t cell) const { return clearance_m_[cell] >= radius_m_; }

  SiteRaster frame_;  // without cells
  double radius_m_;
  std::vector<float> clearance_m_;  // by cell
};

// Length of a way (m).
double LengthOf(const std::vector<Eigen::Vector2d>& path);

}  // namespace survey
