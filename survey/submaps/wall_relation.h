// SPDX-License-Identifier: Apache-2.0
//
// How two walls of a building lie to each other, each seen in its own scan: what a person knows of corridors, where the
// place along the wall stays open (the human correction factors of [Nashed18]). Frames: base and target are the frames
// of the two scans; m, rad.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "survey/geometry/pose2.h"

namespace survey {

enum class WallRelation { kCollinear, kParallel, kPerpendicular };

constexpr std::string_view Name(WallRelation relation) {
  switch (relation) {
    case WallRelation::kCollinear:
      return "collinear";
    case WallRelation::kParallel:
      return "parallel";
    case WallRelation::kPerpendicular:
      return "perpendicular";
  }
  return "";
}

struct WallSegment {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();

  Eigen::Vector2d Middle() const { return 0.5 * (a + b); }
  double Heading() const { return std::atan2(b.y() - a.y(), b.x() - a.x()); }
  double Length() const { return (b - a).norm(); }
};

inline WallSegment operator*(const Pose2& frame_from_wall, const WallSegment& wall) {
  return {frame_from_wall * wall.a, frame_from_wall * wall.b};
}

struct WallPair {
  WallRelation relation = WallRelation::kCollinear;
  WallSegment in_base;
  WallSegment in_target;

  // How many values it observes: only collinear walls hold the distance.
  int Rows() const { return relation == WallRelation::kCollinear ? 2 : 1; }
};

// error: distance of the middle of the target's wall from the line of the base's wall (zero unless collinear), and the
// angle between the walls less that of the relation, within a quarter turn: walls have no direction.
struct WallResidual {
  Eigen::Vector2d error;
  Eigen::Matrix<double, 2, 3> d_base;
  Eigen::Matrix<double, 2, 3> d_target;
};
WallResidual EvaluateWalls(const WallPair& walls, const Pose2& base, const Pose2& target);

// Sum of the squared residuals over their sigmas (m, rad): chi-square with Rows() degrees of freedom.
double SquaredNormalisedResidual(const WallPair& walls, const Eigen::Vector2d& sigma, const Pose2& base,
                                 const Pose2& target);

// Whether the relation may be meant: at these poses the walls are off by less than 30 degrees.
bool MayHold(const WallPair& walls, const Pose2& base, const Pose2& target);

}  // namespace survey
