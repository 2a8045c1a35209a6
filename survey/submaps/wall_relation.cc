// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/wall_relation.h"

#include <cmath>
#include <numbers>

namespace survey {
namespace {

constexpr double kFarthestOff_rad = std::numbers::pi / 6.0;

}  // namespace

WallResidual EvaluateWalls(const WallPair& walls, const Pose2& base, const Pose2& target) {
  const double right_angle = walls.relation == WallRelation::kPerpendicular ? 0.5 * std::numbers::pi : 0.0;
  const double turn = target.theta + walls.in_target.Heading() - base.theta - walls.in_base.Heading() - right_angle;
  WallResidual r{Eigen::Vector2d(0.0, std::remainder(turn, std::numbers::pi)), Eigen::Matrix<double, 2, 3>::Zero(),
                 Eigen::Matrix<double, 2, 3>::Zero()};
  r.d_base(1, 2) = -1.0;
  r.d_target(1, 2) = 1.0;
  if (walls.relation != WallRelation::kCollinear) return r;
  const double heading = walls.in_base.Heading();
  const Eigen::RowVector2d normal(-std::sin(heading), std::cos(heading));
  const Eigen::Vector2d middle = Between(base, target) * walls.in_target.Middle();
  r.error.x() = normal * (middle - walls.in_base.Middle());
  const Eigen::Matrix2d base_axes = Rotation2(-base.theta);
  const Eigen::Vector2d lever = Rotation2(target.theta - base.theta) * walls.in_target.Middle();
  r.d_base.row(0) << -normal * base_axes, normal * Eigen::Vector2d(middle.y(), -middle.x());
  r.d_target.row(0) << normal * base_axes, normal * Eigen::Vector2d(-lever.y(), lever.x());
  return r;
}

double SquaredNormalisedResidual(const WallPair& walls, const Eigen::Vector2d& sigma, const Pose2& base,
                                 const Pose2& target) {
  return EvaluateWalls(walls, base, target).error.cwiseQuotient(sigma).squaredNorm();
}

bool MayHold(const WallPair& walls, const Pose2& base, const Pose2& target) {
  return std::abs(EvaluateWalls(walls, base, target).error.y()) < kFarthestOff_rad;
}

}  // namespace survey
