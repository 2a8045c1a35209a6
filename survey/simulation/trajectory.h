// SPDX-License-Identifier: Apache-2.0
//
// Exact motion of the platform: a uniform cubic B-spline over time of the LiDAR centre's position and the body's
// attitude, so that velocities, accelerations and angular rates are its exact derivatives and continuous. Frame: plan
// (x east, y north, z up). Attitude plan_from_body = Rz(yaw) Ry(pitch) Rx(roll).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "survey/geometry/pose2.h"

namespace survey {

// Components of a knot: x, y, z of the LiDAR centre (m), yaw (not wrapped), pitch, roll of the body (rad).
using MotionVector = Eigen::Matrix<double, 6, 1>;

struct MotionState {
  MotionVector value;  // x y z yaw pitch roll
  MotionVector first;  // time derivatives
  MotionVector second;

  Eigen::Vector3d Position() const { return value.head<3>(); }
  Eigen::Matrix3d PlanFromBody() const;
  Eigen::Vector3d AngularRateInBody() const;
  Eigen::Vector3d AngularAccelerationInBody() const;
};

class Trajectory {
 public:
  // knots[k] is the control value at start_s + k * step_s. At least four.
  Trajectory(double start_s, double step_s, std::vector<MotionVector> knots, const Pose2& body_from_lidar);

  // The spline is defined from the second to the last but one knot.
  double start_s() const { return start_s_ + step_s_; }
  double end_s() const { return start_s_ + step_s_ * static_cast<double>(knots_.size() - 2); }

  MotionState At(double time_s) const;  // clamped to the span

  Eigen::Isometry3d PlanFromLidar(double time_s) const;
  Eigen::Isometry3d PlanFromBody(double time_s) const;
  // In the plane: position and yaw.
  Pose2 PlanarPlanFromLidar(double time_s) const;
  Pose2 PlanarPlanFromBody(double time_s) const;

  // Acceleration of the body's origin in the plan frame (m/s2).
  Eigen::Vector3d BodyAcceleration(double time_s) const;
  Eigen::Vector3d BodyVelocity(double time_s) const;

  const Pose2& body_from_lidar() const { return body_from_lidar_; }

 private:
  double start_s_;
  double step_s_;
  std::vector<MotionVector> knots_;
  Pose2 body_from_lidar_;
};

}  // namespace survey
