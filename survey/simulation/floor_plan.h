// SPDX-License-Identifier: Apache-2.0
//
// The building of a scenario as plain shapes: what stands still and stops or reflects a beam. Plan frame, metres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "survey/simulation/scenario.h"

namespace survey {

// A straight piece of a wall, a pillar or a car.
struct Face {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

struct Disc {
  Eigen::Vector2d centre;
  double radius_m;
};

struct Pane {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  double response;
};

struct FloorPlan {
  std::vector<Pillar> pillars;    // the single ones and those of the grids
  std::vector<Car> cars;          // the single ones and those of the rows
  std::vector<Face> solid_faces;  // walls and square pillars: what features and the reference cloud show
  std::vector<Face> car_faces;
  std::vector<Disc> pillar_discs;
  std::vector<Disc> car_discs;
  std::vector<Pane> panes;
};

FloorPlan BuildFloorPlan(const Scenario& scenario);

// Where the faces of walls and pillars cross or end at the same place within 1 mm: true for a corner feature.
bool IsCorner(const FloorPlan& plan, const Eigen::Vector2d& position);

}  // namespace survey
