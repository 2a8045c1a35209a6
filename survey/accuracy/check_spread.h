// SPDX-License-Identifier: Apache-2.0
//
// How checks and control are spread over what was mapped: checks in one corner prove nothing about the others [NSSDA],
// and a map far from control is extrapolated.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace survey {

// The map is represented by the positions of its scans, site frame (m).
struct CheckSpread {
  double hull_share = 0.0;              // area of the checks' convex hull / that of the scans; may exceed 1
  std::vector<double> quadrant_shares;  // of the checks, NE, NW, SW, SE of the middle of the scans' extent
  double nearest_control_min = 0.0;     // distance of the checks to the nearest used control
  double nearest_control_median = 0.0;
  double nearest_control_max = 0.0;

  bool Uneven() const;  // [NSSDA] guidance: at least 20 % of the checks in each quadrant
};

// Empty without checks, scans or control.
std::optional<CheckSpread> DescribeSpread(std::span<const Eigen::Vector2d> checks,
                                          std::span<const Eigen::Vector2d> scans,
                                          std::span<const Eigen::Vector2d> control);

double ConvexHullArea(std::vector<Eigen::Vector2d> points);

// The part of a path that lies farther than `limit_m` from all of `control`.
struct FarFromControl {
  double path_length = 0.0;  // of that part, m
  double distance = 0.0;     // of its farthest place, m
  Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
};

// Empty when no scan lies so far. Precondition: control is not empty.
std::optional<FarFromControl> FindFarFromControl(std::span<const Eigen::Vector2d> path,
                                                 std::span<const Eigen::Vector2d> control, double limit_m);

}  // namespace survey
