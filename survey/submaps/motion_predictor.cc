// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/motion_predictor.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr double kInnovationWeight = 0.05;
constexpr StampNs kLeadStep_ns = 50'000'000;
constexpr int kLeadSteps = 14;               // to either side
constexpr double kMinExcitation_rad2 = 0.5;  // squared turns before a lead is believed
constexpr double kMinGain = 0.7;             // a lead must lower the squared differences to this part
constexpr double kVelocityMemory_s = 0.1;
constexpr double kMaxVelocitySpan_s = 1.0;  // constant velocity is not continued for longer

double Square(double value) { return value * value; }

}  // namespace

OdometryLead::OdometryLead(const OdometryTrack& odometry) : odometry_(odometry) {
  for (int k = -kLeadSteps; k <= kLeadSteps; ++k) leads_.push_back(k * kLeadStep_ns);
  squares_.resize(leads_.size(), 0.0);
  headings_.resize(leads_.size());
}

void OdometryLead::Add(StampNs from_ns, StampNs to_ns, double matched_turn_rad) {
  const bool follows = from_ns == last_ns_;
  last_ns_ = to_ns;
  for (std::size_t i = 0; i < leads_.size(); ++i) {
    const std::optional<Pose2> pose = odometry_.At(to_ns - leads_[i]);
    if (follows && pose && headings_[i])
      squares_[i] += Square(NormalizeAngle(pose->theta - *headings_[i] - matched_turn_rad));
    headings_[i] = pose ? std::optional(pose->theta) : std::nullopt;
  }
  if (!follows) return;
  excitation_ += Square(matched_turn_rad);
  if (excitation_ < kMinExcitation_rad2) return;
  const auto best = std::min_element(squares_.begin(), squares_.end());
  const auto current = static_cast<std::size_t>(lead_ns_ / kLeadStep_ns + kLeadSteps);
  if (*best < kMinGain * squares_[current]) lead_ns_ = leads_[static_cast<std::size_t>(best - squares_.begin())];
}

void MotionPredictor::Innovations::Add(const Pose2& predicted_from_matched) {
  square_m += kInnovationWeight * (0.5 * predicted_from_matched.Translation().squaredNorm() - square_m);
  square_rad += kInnovationWeight * (Square(predicted_from_matched.theta) - square_rad);
}

MotionPredictor::MotionPredictor(const Session& session, const MotionNoise& noise, const InertialOptions& inertial)
    : setup_(session.setup),
      noise_(noise),
      odometry_(session.odometry, noise.max_odometry_gap_s),
      lead_(odometry_),
      navigator_(session, inertial) {}

// Time from the last scan, evened out where scans were stamped in bursts, as loggers do that empty a buffer late.
double MotionPredictor::EvenSpan(StampNs stamp_ns) const {
  const double dt = Seconds(stamp_ns - last_stamp_ns_);
  if (mean_span_s_ <= 0.0 || dt > 5.0 * mean_span_s_) return dt;
  return std::clamp(dt, 0.5 * mean_span_s_, 2.0 * mean_span_s_);
}

PredictedPose MotionPredictor::Predict(StampNs stamp_ns) {
  if (!started_) {
    PredictedPose origin;
    origin.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal();
    return origin;
  }
  const double dt = EvenSpan(stamp_ns);
  const StampNs lead = lead_.lead_ns();
  inertial_motion_ = navigator_.Advance(stamp_ns);
  inertial_.motion = inertial_motion_ ? std::optional(inertial_motion_->motion) : std::nullopt;
  wheels_.motion = odometry_.LidarMotion(last_stamp_ns_ - lead, stamp_ns - lead, setup_.body_from_lidar);
  const double t = std::min(dt, kMaxVelocitySpan_s);
  velocity_.motion = Pose2{last_twist_.vx * t, last_twist_.vy * t, last_twist_.omega * t};
  PredictedPose predicted = Fuse(dt);
  predicted_pose_ = predicted.local_from_scan;
  return predicted;
}

// Each source by its innovations, and at least by what it cannot do better than, so that a quiet stretch does not make
// it overconfident. Constant velocity is not continued over a gap of the scans, but its uncertainty is.
std::vector<MotionPredictor::Estimate> MotionPredictor::Estimates(double dt) const {
  std::vector<Estimate> estimates = {
      {&*velocity_.motion, Square(0.002 + 0.25 * noise_.acceleration_m_s2 * dt * dt) + velocity_.innovations.square_m,
       Square(0.001 + 0.25 * noise_.acceleration_rad_s2 * dt * dt) + velocity_.innovations.square_rad}};
  if (wheels_.motion) {
    estimates.push_back({&*wheels_.motion,
                         Square(0.002 + 0.02 * wheels_.motion->Translation().norm()) + wheels_.innovations.square_m,
                         Square(0.001 + 0.05 * std::abs(wheels_.motion->theta)) + wheels_.innovations.square_rad});
  }
  if (inertial_.motion) {
    estimates.push_back({&*inertial_.motion,
                         Square(0.001) + inertial_motion_->variances(0) + inertial_.innovations.square_m,
                         Square(0.0002) + inertial_motion_->variances(1) + inertial_.innovations.square_rad});
  }
  return estimates;
}

// Weighted mean of what the sources say, position and heading apart.
PredictedPose MotionPredictor::Fuse(double dt) const {
  const double t = std::min(dt, kMaxVelocitySpan_s);
  Pose2 motion = *velocity_.motion;
  double weight_m = 0.0;
  double weight_rad = 0.0;
  for (const Estimate& estimate : Estimates(dt)) {
    weight_m += 1.0 / estimate.variance_m;
    weight_rad += 1.0 / estimate.variance_rad;
    const double share_m = 1.0 / (estimate.variance_m * weight_m);
    motion.x += share_m * (estimate.motion->x - motion.x);
    motion.y += share_m * (estimate.motion->y - motion.y);
    motion.theta += NormalizeAngle(estimate.motion->theta - motion.theta) / (estimate.variance_rad * weight_rad);
  }
  const double path = motion.Translation().norm();
  double sigma_m = noise_.sigma_m + noise_.acceleration_m_s2 * t * dt;
  double sigma_rad = noise_.sigma_rad + noise_.acceleration_rad_s2 * t * dt;
  PredictedPose predicted;
  predicted.source = Prediction::kConstantVelocity;
  if (wheels_.motion) {
    predicted.source = Prediction::kOdometry;
    sigma_m = noise_.sigma_m + noise_.sigma_m_per_m * path;
    sigma_rad = noise_.sigma_rad + noise_.sigma_rad_per_rad * std::abs(motion.theta) + noise_.sigma_rad_per_m * path;
  }
  if (inertial_.motion) {
    predicted.source = Prediction::kInertial;
    predicted.level_from_lidar = inertial_motion_->level_from_lidar;
    sigma_m = std::min(sigma_m, noise_.sigma_m + std::sqrt(inertial_motion_->variances(0)));
    sigma_rad = std::min(sigma_rad, noise_.sigma_inertial_rad + std::sqrt(inertial_motion_->variances(1)));
  }
  predicted.local_from_scan = last_pose_ * motion;
  predicted.twist = inertial_.motion ? inertial_motion_->twist : TwistBetween({}, motion, dt);
  const double variance_m = Square(sigma_m) + 2.0 * fused_.square_m;
  const double variance_rad = Square(sigma_rad) + 2.0 * fused_.square_rad;
  predicted.covariance = Eigen::Vector3d(variance_m, variance_m, variance_rad).asDiagonal();
  return predicted;
}

void MotionPredictor::Update(StampNs stamp_ns, const Pose2& local_from_scan, const Eigen::Matrix3d& covariance,
                             bool matched) {
  if (started_) {
    const Pose2 motion = Between(last_pose_, local_from_scan);
    if (matched) {
      for (Source* source : {&inertial_, &wheels_, &velocity_}) {
        if (source->motion) source->innovations.Add(Between(*source->motion, motion));
      }
      fused_.Add(Between(predicted_pose_, local_from_scan));
      lead_.Add(last_stamp_ns_, stamp_ns, motion.theta);
    }
    const double dt = EvenSpan(stamp_ns);
    // At a high rate the difference of two matches is mostly their noise.
    const double share = std::min(1.0, dt / kVelocityMemory_s);
    const Twist2 twist = TwistBetween(last_pose_, local_from_scan, dt);
    last_twist_.vx += share * (twist.vx - last_twist_.vx);
    last_twist_.vy += share * (twist.vy - last_twist_.vy);
    last_twist_.omega += share * (twist.omega - last_twist_.omega);
    const double span = std::min(Seconds(stamp_ns - last_stamp_ns_), kMaxVelocitySpan_s);
    mean_span_s_ += (mean_span_s_ > 0.0 ? kInnovationWeight : 1.0) * (span - mean_span_s_);
  }
  navigator_.Observe(stamp_ns, {local_from_scan, covariance, matched, last_twist_, lead_.lead_ns()});
  started_ = true;
  last_pose_ = local_from_scan;
  last_stamp_ns_ = stamp_ns;
}

}  // namespace survey
