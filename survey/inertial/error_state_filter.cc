// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/error_state_filter.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "survey/inertial/strapdown.h"

namespace survey {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kP = 0;    // position
constexpr int kV = 3;    // velocity
constexpr int kPsi = 6;  // attitude
constexpr int kG = 9;    // gyro bias
constexpr int kA = 12;   // accelerometer bias

// Chi-square beyond which an observation of 1, 2, 3 or 6 numbers is refused.
constexpr double kGate1 = 15.1;
constexpr double kGate2 = 18.4;
constexpr double kGate3 = 21.1;
constexpr double kGate6 = 27.9;

Matrix3d Cross(const Vector3d& v) {
  return (Matrix3d() << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0).finished();
}

Earth WithUprightRotation(const Earth& earth) {
  Earth upright = earth;
  upright.rotation_in_nav.head<2>().setZero();
  upright.gravity_in_nav.head<2>().setZero();
  return upright;
}

}  // namespace

InertialState Plus(const InertialState& state, const ErrorVector& error) {
  return {state.p_in_local + error.segment<3>(kP), state.v_in_local + error.segment<3>(kV),
          (FromRotationVector(error.segment<3>(kPsi)) * state.local_from_body).normalized(),
          state.gyro_bias + error.segment<3>(kG), state.accelerometer_bias + error.segment<3>(kA)};
}

ErrorVector Minus(const InertialState& to, const InertialState& from) {
  ErrorVector error;
  error << to.p_in_local - from.p_in_local, to.v_in_local - from.v_in_local,
      ToRotationVector(to.local_from_body * from.local_from_body.conjugate()), to.gyro_bias - from.gyro_bias,
      to.accelerometer_bias - from.accelerometer_bias;
  return error;
}

double HeadingOf(const Quaterniond& local_from_body) {
  const Vector3d ahead = local_from_body * Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

Pose2 PlanarPose(const InertialState& state) {
  return {state.p_in_local.x(), state.p_in_local.y(), HeadingOf(state.local_from_body)};
}

ErrorMatrix ToMatrix(const ErrorTransition& t) {
  ErrorMatrix phi = ErrorMatrix::Identity();
  phi.block<3, 3>(kP, kV).diagonal().setConstant(t.seconds);
  phi.block<3, 3>(kP, kPsi) = t.p_from_psi;
  phi.block<3, 3>(kP, kG) = t.p_from_gyro;
  phi.block<3, 3>(kP, kA) = t.p_from_accelerometer;
  phi.block<3, 3>(kV, kPsi) = t.v_from_psi;
  phi.block<3, 3>(kV, kG) = t.v_from_gyro;
  phi.block<3, 3>(kV, kA) = -t.turned;
  phi.block<3, 3>(kPsi, kG) = -t.turned;
  return phi;
}

ErrorStateFilter::ErrorStateFilter(const InertialState& state, const ErrorMatrix& covariance,
                                   const InertialNoise& noise, const Earth& earth)
    : state_(state), covariance_(covariance), noise_(noise), earth_(WithUprightRotation(earth)) {}

void ErrorStateFilter::Propagate(const ImuIncrement& raw) {
  const ImuIncrement now = Corrected(raw, state_.gyro_bias, state_.accelerometer_bias);
  const double dt = now.dt_s;
  const Vector3d turn_of_local = dt * earth_.rotation_in_nav;
  const Vector3d gain = VelocityGain(state_.local_from_body, turn_of_local, previous_, now);
  const Vector3d v = state_.v_in_local;
  // Over a block the Earth is flat: no transport rate.
  state_.v_in_local += gain + dt * (earth_.gravity_in_nav - 2.0 * earth_.rotation_in_nav.cross(v + 0.5 * gain));
  state_.p_in_local += 0.5 * dt * (v + state_.v_in_local);
  const Matrix3d turned = dt * state_.local_from_body.toRotationMatrix();
  state_.local_from_body = UpdateAttitude(state_.local_from_body, turn_of_local, previous_, now);
  previous_ = now;

  const Matrix3d gained = Cross(gain);
  ErrorTransition& t = transition_;
  const Matrix3d half_turned = t.turned + 0.5 * turned;
  const Matrix3d gained_by_gyro = gained * half_turned;
  t.p_from_psi += dt * (t.v_from_psi - 0.5 * gained);
  t.p_from_gyro += dt * (t.v_from_gyro + 0.5 * gained_by_gyro);
  t.p_from_accelerometer -= dt * half_turned;
  t.v_from_psi -= gained;
  t.v_from_gyro += gained_by_gyro;
  t.turned += turned;
  t.seconds += dt;
}

ErrorTransition ErrorStateFilter::PropagateCovariance() {
  const ErrorTransition passed = transition_;
  transition_ = {};
  if (!(passed.seconds > 0.0)) return passed;
  // Half of the noise before the transition, half after it: its parts by position and velocity come by themselves.
  const double half = 0.5 * passed.seconds;
  const auto square = [](double x) { return x * x; };
  ErrorVector noise = ErrorVector::Zero();
  noise.segment<3>(kV).setConstant(half * square(noise_.accelerometer_noise_m_s2_rthz));
  noise.segment<3>(kPsi).setConstant(half * square(noise_.gyro_noise_rad_s_rthz));
  noise.segment<3>(kG).setConstant(half * square(noise_.gyro_walk_rad_s2_rthz));
  noise.segment<3>(kA).setConstant(half * square(noise_.accelerometer_walk_m_s3_rthz));
  const ErrorMatrix phi = ToMatrix(passed);
  covariance_.diagonal() += noise;
  ErrorMatrix moved;
  moved.noalias() = phi * covariance_;
  covariance_.noalias() = moved * phi.transpose();
  covariance_.diagonal() += noise;
  return passed;
}

bool ErrorStateFilter::Update(const Design& design, const Residual& residual, const Noise& noise, double gate) {
  const Design crossed = design * covariance_;  // transposed
  const Eigen::LLT<Noise> factor(crossed * design.transpose() + noise);
  if (factor.info() != Eigen::Success) return false;
  const Residual weighted = factor.solve(residual);
  if (!(residual.dot(weighted) <= gate)) return false;
  state_ = Plus(state_, crossed.transpose() * weighted);
  // P - K S K^T as a product with its own transpose, so that P stays symmetric.
  const Design root = factor.matrixL().solve(crossed);
  covariance_.noalias() -= root.transpose() * root;
  return true;
}

Eigen::Matrix<double, 3, 15> PlanarPoseDesign(const InertialState& state, const Pose2& body_from_frame) {
  Eigen::Matrix<double, 3, 15> design = Eigen::Matrix<double, 3, 15>::Zero();
  design.block<2, 2>(0, kP).setIdentity();
  design.block<2, 3>(0, kPsi) = -Cross(state.local_from_body * LeverArm(body_from_frame)).topRows<2>();
  const Vector3d ahead = state.local_from_body * Vector3d::UnitX();
  const double slope = ahead.z() / ahead.head<2>().squaredNorm();
  design.block<1, 3>(2, kPsi) = Vector3d(-slope * ahead.x(), -slope * ahead.y(), 1.0).transpose();
  return design;
}

bool ErrorStateFilter::UpdatePlanarPose(const Pose2& local_from_frame, const Matrix3d& covariance,
                                        const Pose2& body_from_frame) {
  const Vector3d place = state_.p_in_local + state_.local_from_body * LeverArm(body_from_frame);
  const double heading = HeadingOf(state_.local_from_body) + body_from_frame.theta;
  const Vector3d residual(local_from_frame.x - place.x(), local_from_frame.y - place.y(),
                          NormalizeAngle(local_from_frame.theta - heading));
  return Update(PlanarPoseDesign(state_, body_from_frame), residual, covariance, kGate3);
}

Eigen::Matrix<double, 2, 15> BodyVelocityDesign(const InertialState& state) {
  const Matrix3d body_from_local = state.local_from_body.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 2, 15> design = Eigen::Matrix<double, 2, 15>::Zero();
  design.block<2, 3>(0, kV) = body_from_local.topRows<2>();
  design.block<2, 3>(0, kPsi) = (body_from_local * Cross(state.v_in_local)).topRows<2>();
  return design;
}

bool ErrorStateFilter::UpdateBodyVelocity(const Eigen::Vector2d& v_in_body, double sigma_m_s) {
  const Vector3d v = state_.local_from_body.conjugate() * state_.v_in_local;
  return Update(BodyVelocityDesign(state_), v_in_body - v.head<2>(),
                sigma_m_s * sigma_m_s * Eigen::Matrix2d::Identity(), kGate2);
}

bool ErrorStateFilter::UpdateLevelVelocity(double sigma_m_s) {
  Design design = Design::Zero(1, 15);
  design(0, kV + 2) = 1.0;
  return Update(design, Residual::Constant(1, -state_.v_in_local.z()), Noise::Constant(1, 1, sigma_m_s * sigma_m_s),
                kGate1);
}

bool ErrorStateFilter::UpdateStandstill(double sigma_m_s, const Vector3d& mean_rate, double seconds) {
  Eigen::Matrix<double, 6, 15> design = Eigen::Matrix<double, 6, 15>::Zero();
  design.block<3, 3>(0, kV).setIdentity();
  design.block<3, 3>(3, kG).setIdentity();
  Eigen::Matrix<double, 6, 1> residual;
  const Vector3d turning = state_.local_from_body.conjugate() * earth_.rotation_in_nav;
  residual << -state_.v_in_local, mean_rate - turning - state_.gyro_bias;
  const double rate_variance = noise_.gyro_noise_rad_s_rthz * noise_.gyro_noise_rad_s_rthz / seconds;
  Eigen::Matrix<double, 6, 1> variances;
  variances << Vector3d::Constant(sigma_m_s * sigma_m_s), Vector3d::Constant(rate_variance);
  return Update(design, residual, Eigen::Matrix<double, 6, 6>(variances.asDiagonal()), kGate6);
}

void ErrorStateFilter::SetPlanarPose(const Pose2& local_from_body, const Matrix3d& covariance) {
  const double turn = local_from_body.theta - HeadingOf(state_.local_from_body);
  const Quaterniond turning = FromRotationVector({0.0, 0.0, turn});
  state_.p_in_local.head<2>() = local_from_body.Translation();
  state_.local_from_body = (turning * state_.local_from_body).normalized();
  state_.v_in_local = turning * state_.v_in_local;
  // Correlations with what was replaced are gone.
  constexpr int kReplaced[] = {kP, kP + 1, kPsi + 2};
  for (const int i : kReplaced) {
    covariance_.row(i).setZero();
    covariance_.col(i).setZero();
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) covariance_(kReplaced[i], kReplaced[j]) = covariance(i, j);
  }
}

}  // namespace survey
