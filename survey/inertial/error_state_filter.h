// SPDX-License-Identifier: Apache-2.0
//
// Error-state Kalman filter of an inertial unit ([Groves13] section 14.2; DESIGN section 6): position, velocity,
// attitude and the biases of gyros and accelerometers, fed by scan matches, odometry and standstill.
//
// Frame `local`: x, y as the block's local frame, z up. Its azimuth is unknown, so of the Earth's rotation only the
// vertical part is taken out; the rest (at most 15 deg/h) is a part of the gyros' biases. Errors are truth minus
// estimate; the attitude error psi (rad, in local) obeys  local_from_body(truth) = exp(psi) local_from_body(estimate).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/geometry/pose2.h"
#include "survey/inertial/earth.h"
#include "survey/inertial/imu_increment.h"

namespace survey {

struct InertialState {
  Eigen::Vector3d p_in_local = Eigen::Vector3d::Zero();  // of the body's origin, m
  Eigen::Vector3d v_in_local = Eigen::Vector3d::Zero();  // m/s
  Eigen::Quaterniond local_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           // rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  // m/s2
};

// Position, velocity, attitude, gyro bias, accelerometer bias.
using ErrorVector = Eigen::Matrix<double, 15, 1>;
using ErrorMatrix = Eigen::Matrix<double, 15, 15>;

// The state moved by an error, and the error that leads from `from` to `to`.
InertialState Plus(const InertialState& state, const ErrorVector& error);
ErrorVector Minus(const InertialState& to, const InertialState& from);

// From the body's origin to that of a frame mounted on it, in the body, m.
inline Eigen::Vector3d LeverArm(const Pose2& body_from_frame) { return {body_from_frame.x, body_from_frame.y, 0.0}; }

double HeadingOf(const Eigen::Quaterniond& local_from_body);
// Body in the plane.
Pose2 PlanarPose(const InertialState& state);

// Defaults: the unit of [CN] section 3.1 (200 deg/h, 2000 mGal) with the noise of its kind.
struct InertialNoise {
  double gyro_noise_rad_s_rthz = 9e-4;
  double accelerometer_noise_m_s2_rthz = 4e-3;  // with the shaking of a cart
  double gyro_walk_rad_s2_rthz = 2e-5;          // of the biases
  double accelerometer_walk_m_s3_rthz = 2e-4;
  double gyro_bias_sigma_rad_s = 9.7e-4;  // where the unit was never quiet
  double accelerometer_bias_sigma_m_s2 = 0.02;
};

// How the errors at the end of an interval depend on those at its start (first order in each sample), in blocks. The
// rest of the 15 x 15 matrix is the identity; p depends on v by `seconds`.
struct ErrorTransition {
  double seconds = 0.0;
  Eigen::Matrix3d p_from_psi = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d p_from_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d p_from_accelerometer = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_from_psi = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v_from_gyro = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();  // integral of local_from_body: psi from gyro, v from accelerometer
};
ErrorMatrix ToMatrix(const ErrorTransition& transition);

class ErrorStateFilter {
 public:
  // `covariance` in the order of ErrorVector. The latitude gives gravity and the Earth's rotation.
  ErrorStateFilter(const InertialState& state, const ErrorMatrix& covariance, const InertialNoise& noise,
                   const Earth& earth);

  // Mechanizes one raw increment; the covariance follows with PropagateCovariance.
  void Propagate(const ImuIncrement& raw);
  // Over all increments since the last call; returns the transition. Call it before an update and at least every tenth
  // of a second.
  ErrorTransition PropagateCovariance();

  // Each update returns false, and changes nothing, when the observation does not fit (chi-square at 1e-4 ... 1e-5).
  // Pose of a body-fixed frame in the plane, x, y (m), heading (rad), as a scan match gives it; body_from_frame is
  // level.
  bool UpdatePlanarPose(const Pose2& local_from_frame, const Eigen::Matrix3d& covariance, const Pose2& body_from_frame);
  // Velocity of the body's origin along the body's x and y, m/s, as odometry gives it.
  bool UpdateBodyVelocity(const Eigen::Vector2d& v_in_body, double sigma_m_s);
  // The platform keeps its height.
  bool UpdateLevelVelocity(double sigma_m_s);
  // The platform stands still: no velocity, and the mean of the gyros over the last `seconds` is their bias.
  bool UpdateStandstill(double sigma_m_s, const Eigen::Vector3d& mean_rate, double seconds);

  // Places the filter without observing: after a gap, or when the block's frame was moved under it.
  void SetPlanarPose(const Pose2& local_from_body, const Eigen::Matrix3d& covariance);

  const InertialState& state() const { return state_; }
  const ErrorMatrix& covariance() const { return covariance_; }

 private:
  // Of an observation of up to 6 numbers. Sized at run time: templates by size would take a minute to compile.
  using Design = Eigen::Matrix<double, Eigen::Dynamic, 15, 0, 6, 15>;
  using Residual = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using Noise = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  bool Update(const Design& design, const Residual& residual, const Noise& noise, double gate);

  InertialState state_;
  ErrorMatrix covariance_;
  InertialNoise noise_;
  Earth earth_;  // the vertical part of its rotation
  ImuIncrement previous_;
  ErrorTransition transition_;
};

// Design rows of the updates, for tests and derivative checks: derivatives by the errors.
Eigen::Matrix<double, 3, 15> PlanarPoseDesign(const InertialState& state, const Pose2& body_from_frame);
Eigen::Matrix<double, 2, 15> BodyVelocityDesign(const InertialState& state);

}  // namespace survey
