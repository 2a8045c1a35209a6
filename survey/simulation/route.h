// SPDX-License-Identifier: Apache-2.0
//
// From the waypoints of a block to an exact motion: straight runs joined by turns of continuous curvature, speed within
// the cart's limits of speed, acceleration and turn rate, stops over the marks, small tilts of an uneven floor.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "survey/simulation/ray_caster.h"
#include "survey/simulation/scenario.h"
#include "survey/simulation/trajectory.h"

namespace survey {

// The LiDAR centre stands still from start to end.
struct Stop {
  std::string point;
  double start_s = 0.0;
  double end_s = 0.0;
};

struct RoutePlan {
  std::optional<Trajectory> trajectory;  // empty when the route cannot be driven
  std::vector<Stop> stops;
  double length_m = 0.0;
  int problem_waypoint = 0;  // number of the waypoint, from 1
  std::string problem;
};

RoutePlan PlanRoute(const Scenario& scenario, const BlockRoute& block, const RayCaster& building);

// Height of the floor above its plane and its slope (east, north).
struct FloorShape {
  double height_m = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};
FloorShape FloorAt(const Scenario& scenario, const Eigen::Vector2d& p_in_plan);

}  // namespace survey
