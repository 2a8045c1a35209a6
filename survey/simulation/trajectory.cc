// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace survey {
namespace {

using Eigen::Vector3d;

Eigen::Matrix3d RotationZyx(double yaw, double pitch, double roll) {
  return (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

// Centre of the lidar seen from the body's origin.
Vector3d LeverOf(const Pose2& body_from_lidar) { return {body_from_lidar.x, body_from_lidar.y, 0.0}; }

}  // namespace

Eigen::Matrix3d MotionState::PlanFromBody() const { return RotationZyx(value[3], value[4], value[5]); }

// The columns are the axes about which yaw, pitch and roll turn, seen in the body.
Vector3d MotionState::AngularRateInBody() const {
  const double sp = std::sin(value[4]);
  const double cp = std::cos(value[4]);
  const double sr = std::sin(value[5]);
  const double cr = std::cos(value[5]);
  return {first[5] - first[3] * sp, first[4] * cr + first[3] * cp * sr, -first[4] * sr + first[3] * cp * cr};
}

Vector3d MotionState::AngularAccelerationInBody() const {
  const double sp = std::sin(value[4]);
  const double cp = std::cos(value[4]);
  const double sr = std::sin(value[5]);
  const double cr = std::cos(value[5]);
  const double yaw = first[3];
  const double pitch = first[4];
  const double roll = first[5];
  return {second[5] - second[3] * sp - yaw * pitch * cp,
          second[4] * cr - pitch * roll * sr + second[3] * cp * sr - yaw * pitch * sp * sr + yaw * roll * cp * cr,
          -second[4] * sr - pitch * roll * cr + second[3] * cp * cr - yaw * pitch * sp * cr - yaw * roll * cp * sr};
}

Trajectory::Trajectory(double start_s, double step_s, std::vector<MotionVector> knots, const Pose2& body_from_lidar)
    : start_s_(start_s), step_s_(step_s), knots_(std::move(knots)), body_from_lidar_(body_from_lidar) {}

MotionState Trajectory::At(double time_s) const {
  const double place = std::clamp((time_s - start_s_) / step_s_, 1.0, static_cast<double>(knots_.size() - 2));
  const std::size_t knot = std::min(static_cast<std::size_t>(place), knots_.size() - 3);
  const double u = place - static_cast<double>(knot);
  const double v = 1.0 - u;
  const MotionVector& a = knots_[knot - 1];
  const MotionVector& b = knots_[knot];
  const MotionVector& c = knots_[knot + 1];
  const MotionVector& d = knots_[knot + 2];
  MotionState state;
  state.value =
      (v * v * v * a + (3 * u * u * u - 6 * u * u + 4) * b + (3 * v * v * v - 6 * v * v + 4) * c + u * u * u * d) / 6.0;
  state.first = (-v * v * a + (3 * u * u - 4 * u) * b + (4 * v - 3 * v * v) * c + u * u * d) / (2.0 * step_s_);
  state.second = (v * a + (3 * u - 2) * b + (3 * v - 2) * c + u * d) / (step_s_ * step_s_);
  return state;
}

Eigen::Isometry3d Trajectory::PlanFromLidar(double time_s) const {
  const MotionState state = At(time_s);
  Eigen::Isometry3d plan_from_lidar = Eigen::Isometry3d::Identity();
  plan_from_lidar.linear() =
      state.PlanFromBody() * Eigen::AngleAxisd(body_from_lidar_.theta, Vector3d::UnitZ()).toRotationMatrix();
  plan_from_lidar.translation() = state.Position();
  return plan_from_lidar;
}

Eigen::Isometry3d Trajectory::PlanFromBody(double time_s) const {
  const MotionState state = At(time_s);
  Eigen::Isometry3d plan_from_body = Eigen::Isometry3d::Identity();
  plan_from_body.linear() = state.PlanFromBody();
  plan_from_body.translation() = state.Position() - plan_from_body.linear() * LeverOf(body_from_lidar_);
  return plan_from_body;
}

Pose2 Trajectory::PlanarPlanFromLidar(double time_s) const {
  const MotionState state = At(time_s);
  return {state.value[0], state.value[1], NormalizeAngle(state.value[3] + body_from_lidar_.theta)};
}

Pose2 Trajectory::PlanarPlanFromBody(double time_s) const {
  return PlanarPlanFromLidar(time_s) * Inverse(body_from_lidar_);
}

Vector3d Trajectory::BodyVelocity(double time_s) const {
  const MotionState state = At(time_s);
  const Vector3d lever = LeverOf(body_from_lidar_);
  return state.first.head<3>() - state.PlanFromBody() * state.AngularRateInBody().cross(lever);
}

Vector3d Trajectory::BodyAcceleration(double time_s) const {
  const MotionState state = At(time_s);
  const Vector3d lever = LeverOf(body_from_lidar_);
  const Vector3d rate = state.AngularRateInBody();
  const Vector3d turning = state.AngularAccelerationInBody().cross(lever) + rate.cross(rate.cross(lever));
  return state.second.head<3>() - state.PlanFromBody() * turning;
}

}  // namespace survey
