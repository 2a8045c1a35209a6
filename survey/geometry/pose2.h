// SPDX-License-Identifier: Apache-2.0
//
// Rigid motions of the plane. A transform is named target_from_source, so that frame errors
// show when read: site_from_scan = site_from_local * local_from_scan; p_in_site = site_from_scan * p_in_scan.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace survey {

// Angle brought to (-pi, pi].
inline double NormalizeAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

inline Eigen::Matrix2d Rotation2(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Eigen::Matrix2d rotation;
  rotation(0, 0) = rotation(1, 1) = c;
  rotation(1, 0) = s;
  rotation(0, 1) = -s;
  return rotation;
}

// Translation in metres, rotation in radians, counter-clockwise positive.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  Eigen::Vector2d Translation() const { return {x, y}; }
  Eigen::Vector3d Vector() const { return {x, y, theta}; }
  static Pose2 FromVector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
};

// c_from_a = c_from_b * b_from_a.
inline Pose2 operator*(const Pose2& c_from_b, const Pose2& b_from_a) {
  const double c = std::cos(c_from_b.theta);
  const double s = std::sin(c_from_b.theta);
  return {c_from_b.x + c * b_from_a.x - s * b_from_a.y, c_from_b.y + s * b_from_a.x + c * b_from_a.y,
          NormalizeAngle(c_from_b.theta + b_from_a.theta)};
}

inline Eigen::Vector2d operator*(const Pose2& b_from_a, const Eigen::Vector2d& p_in_a) {
  const double c = std::cos(b_from_a.theta);
  const double s = std::sin(b_from_a.theta);
  return {b_from_a.x + c * p_in_a.x() - s * p_in_a.y(), b_from_a.y + s * p_in_a.x() + c * p_in_a.y()};
}

// a_from_b of b_from_a.
inline Pose2 Inverse(const Pose2& b_from_a) {
  const double c = std::cos(b_from_a.theta);
  const double s = std::sin(b_from_a.theta);
  return {-c * b_from_a.x - s * b_from_a.y, s * b_from_a.x - c * b_from_a.y, -b_from_a.theta};
}

// The motion from pose a to pose b, both in one frame: a_from_b.
inline Pose2 Between(const Pose2& frame_from_a, const Pose2& frame_from_b) {
  return Inverse(frame_from_a) * frame_from_b;
}

// Covariance of x, y, theta seen in axes turned by -angle: the errors turned by +angle.
Eigen::Matrix3d RotatedCovariance(const Eigen::Matrix3d& covariance, double angle_rad);

// Pose on the way from a (fraction 0) to b (fraction 1): translation linear, rotation along the shorter arc.
// Fractions outside [0, 1] extrapolate.
inline Pose2 Interpolate(const Pose2& a, const Pose2& b, double fraction) {
  return {a.x + fraction * (b.x - a.x), a.y + fraction * (b.y - a.y),
          NormalizeAngle(a.theta + fraction * NormalizeAngle(b.theta - a.theta))};
}

}  // namespace survey
