// SPDX-License-Identifier: Apache-2.0
//
// The residuals of the pose graph with their derivatives, one function each; whitening is the caller's.
#pragma once

#include <Eigen/Core>

#include "survey/geometry/pose2.h"

namespace survey {

// [CN] eq. (10), as measured minus computed with the signs of eq. (10) turned so that both parts are base_from_target:
//   e = (R_base' (t_target - t_base), theta_target - theta_base) - base_from_target.
struct RelativePoseResidual {
  Eigen::Vector3d error;
  Eigen::Matrix3d d_base;
  Eigen::Matrix3d d_target;
};
inline RelativePoseResidual EvaluateRelativePose(const Pose2& base, const Pose2& target,
                                                 const Pose2& base_from_target) {
  const double c = std::cos(base.theta);
  const double s = std::sin(base.theta);
  const double dx = target.x - base.x;
  const double dy = target.y - base.y;
  RelativePoseResidual r;
  r.error << c * dx + s * dy - base_from_target.x, -s * dx + c * dy - base_from_target.y,
      NormalizeAngle(target.theta - base.theta - base_from_target.theta);
  r.d_base << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0, 0, -1;
  r.d_target << c, s, 0, -s, c, 0, 0, 0, 1;
  return r;
}

// [CN] eq. (11): e = R_pose' (point - t_pose) - p_in_pose, in the frame of the pose, where its covariance is known.
struct MarkResidual {
  Eigen::Vector2d error;
  Eigen::Matrix<double, 2, 3> d_pose;
  Eigen::Matrix2d d_point;
};
inline MarkResidual EvaluateMark(const Pose2& pose, const Eigen::Vector2d& point, const Eigen::Vector2d& p_in_pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  const double dx = point.x() - pose.x;
  const double dy = point.y() - pose.y;
  MarkResidual r;
  r.error << c * dx + s * dy - p_in_pose.x(), -s * dx + c * dy - p_in_pose.y();
  r.d_pose << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy;
  r.d_point << c, s, -s, c;
  return r;
}

// W with W' W = covariance^-1, so that W e has unit covariance.
template <int N>
Eigen::Matrix<double, N, N> Whitening(const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::Matrix<double, N, N> lower = covariance.llt().matrixL();
  return lower.template triangularView<Eigen::Lower>().solve(
      Eigen::Matrix<double, N, N>::Identity(covariance.rows(), covariance.cols()));
}

}  // namespace survey
