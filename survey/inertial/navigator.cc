// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/navigator.h"

#include <algorithm>
#include <cmath>

#include "survey/inertial/imu_checks.h"
#include "survey/inertial/strapdown.h"

namespace survey {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr StampNs kMarkMargin = 300'000'000;   // people write marks a little too long
constexpr double kContradictionLimit_s = 1.0;  // then the filter follows the matches
constexpr double kMaxOdometryGap_s = 0.5;
constexpr double kLongestMeanVelocity_s = 1.0;  // over longer, a mean velocity is not the one at the end

double Square(double x) { return x * x; }

ErrorMatrix StartCovariance(double tilt_sigma, double velocity_sigma, double gyro_sigma, double accelerometer_sigma,
                            const Matrix3d& pose) {
  ErrorMatrix covariance = ErrorMatrix::Zero();
  covariance.diagonal() << pose(0, 0), pose(1, 1), 1e-4, Vector3d::Constant(Square(velocity_sigma)), Square(tilt_sigma),
      Square(tilt_sigma), pose(2, 2), Vector3d::Constant(Square(gyro_sigma)),
      Vector3d::Constant(Square(accelerometer_sigma));
  return covariance;
}

// Of the way over dt, m2 per axis: by velocity, and over a gap of the scans by tilt, gyro and accelerometer biases,
// which grow with its higher powers.
double VarianceOfWay(const ErrorMatrix& covariance, double gravity, double dt) {
  const auto level = [&](int axis) { return std::max(covariance(axis, axis), covariance(axis + 1, axis + 1)); };
  const double tilt = level(6) + level(9) * Square(dt / 3.0);
  return level(3) * Square(dt) + (Square(gravity) * tilt + level(12)) * Square(0.5 * dt * dt);
}

// Levelled axes with the lidar's heading zero: columns are the lidar's x and y seen from above.
Eigen::Matrix2d LevelFromLidar(const Eigen::Quaterniond& local_from_body, double lidar_yaw) {
  const Matrix3d local_from_lidar =
      (local_from_body * Eigen::AngleAxisd(lidar_yaw, Vector3d::UnitZ())).toRotationMatrix();
  const double heading = HeadingOf(local_from_body) + lidar_yaw;
  return Rotation2(-heading) * local_from_lidar.topLeftCorner<2, 2>();
}

}  // namespace

InertialNavigator::InertialNavigator(const Session& session, const InertialOptions& options)
    : session_(session),
      options_(options),
      earth_(EarthAt(options.latitude_rad, 0.0)),
      odometry_(session.odometry, kMaxOdometryGap_s) {
  if (!options.use) return;
  imu_ = UsableImu(session.imu);
  if (imu_.empty()) return;
  quiet_ = FindQuiet(imu_, {});
  const ScanGeometry& geometry = session.geometries.front();
  sweep_ns_ = static_cast<StampNs>(1e9 * geometry.time_increment_s * geometry.num_beams);
}

std::size_t InertialNavigator::FirstFrom(StampNs stamp_ns) const {
  const auto found = std::lower_bound(imu_.begin(), imu_.end(), stamp_ns,
                                      [](const ImuSample& sample, StampNs stamp) { return sample.stamp_ns < stamp; });
  return static_cast<std::size_t>(found - imu_.begin());
}

// There are samples on both sides, close enough to each other.
bool InertialNavigator::Covers(StampNs stamp_ns) const {
  const std::size_t after = FirstFrom(stamp_ns);
  if (after == imu_.size()) return false;
  if (imu_[after].stamp_ns == stamp_ns) return true;
  return after > 0 && Seconds(imu_[after].stamp_ns - imu_[after - 1].stamp_ns) <= options_.max_gap_s;
}

// Requires Covers.
ImuSample InertialNavigator::SampleAt(StampNs stamp_ns) const {
  const std::size_t after = FirstFrom(stamp_ns);
  if (imu_[after].stamp_ns == stamp_ns) return imu_[after];
  const ImuSample& a = imu_[after - 1];
  const ImuSample& b = imu_[after];
  const double f = Seconds(stamp_ns - a.stamp_ns) / Seconds(b.stamp_ns - a.stamp_ns);
  return {stamp_ns, a.angular_rate_in_body + f * (b.angular_rate_in_body - a.angular_rate_in_body),
          a.specific_force_in_body + f * (b.specific_force_in_body - a.specific_force_in_body)};
}

Pose2 InertialNavigator::LidarPose(const InertialState& state) const {
  const Pose2& mounting = session_.setup.body_from_lidar;
  const Vector3d place = state.p_in_local + state.local_from_body * LeverArm(mounting);
  return {place.x(), place.y(), NormalizeAngle(HeadingOf(state.local_from_body) + mounting.theta)};
}

// A tilt that comes and goes is one doubt.
void InertialNavigator::WatchTilt(StampNs stamp_ns) {
  const Vector3d up = filter_->state().local_from_body * Vector3d::UnitZ();
  const double tilt = std::acos(std::clamp(up.z(), -1.0, 1.0));
  if (tilt > options_.max_tilt_rad) {
    if (!tilted_) tilted_ = InertialDoubt{InertialDoubt::Cause::kTilted, stamp_ns, 0.0};
    tilted_->value = std::max(tilted_->value, tilt);
  } else if (tilted_) {
    summary_.doubts.push_back(*tilted_);
    tilted_.reset();
  }
}

// False, with the filter stopped, when samples are missing on the way.
bool InertialNavigator::MechanizeTo(StampNs stamp_ns) {
  const auto step = [&](const ImuSample& to) {
    const ImuIncrement increment = IncrementBetween(now_, to);
    filter_->Propagate(increment);
    turned_since_step_ += increment.dtheta;
    now_ = to;
  };
  if (!Covers(stamp_ns)) return false;
  for (; next_ < imu_.size() && imu_[next_].stamp_ns <= stamp_ns; ++next_) {
    if (Seconds(imu_[next_].stamp_ns - now_.stamp_ns) > options_.max_gap_s) return false;
    step(imu_[next_]);
  }
  if (now_.stamp_ns < stamp_ns) step(SampleAt(stamp_ns));
  time_ns_ = stamp_ns;
  return true;
}

// The scan's own sweep is known, too: its mean rate instead of the one before.
Twist2 InertialNavigator::LidarTwist(StampNs stamp_ns) const {
  const InertialState& state = filter_->state();
  Vector3d sum = now_.angular_rate_in_body;
  double count = 1.0;
  for (std::size_t i = next_; i < imu_.size() && imu_[i].stamp_ns <= stamp_ns + sweep_ns_; ++i) {
    sum += imu_[i].angular_rate_in_body;
    count += 1.0;
  }
  const Vector3d rate = sum / count - state.gyro_bias;
  const Pose2& mounting = session_.setup.body_from_lidar;
  const Vector3d velocity = state.local_from_body.conjugate() * state.v_in_local + rate.cross(LeverArm(mounting));
  const Eigen::Vector2d v = Rotation2(-mounting.theta) * velocity.head<2>();
  return {v.x(), v.y(), rate.z()};
}

std::optional<InertialMotion> InertialNavigator::Advance(StampNs stamp_ns) {
  if (!filter_) return std::nullopt;
  const double dt = Seconds(stamp_ns - time_ns_);
  if (!MechanizeTo(stamp_ns)) {
    last_known_ = filter_->state();
    filter_.reset();
    return std::nullopt;
  }
  const InertialState& state = filter_->state();
  const ErrorMatrix& covariance = filter_->covariance();
  InertialMotion moved;
  moved.motion = Between(last_lidar_, LidarPose(state));
  moved.twist = LidarTwist(stamp_ns);
  moved.level_from_lidar = LevelFromLidar(state.local_from_body, session_.setup.body_from_lidar.theta);
  moved.variances = {VarianceOfWay(filter_->covariance(), earth_.gravity_in_nav.norm(), dt),
                     covariance(11, 11) * dt * dt + Square(options_.noise.gyro_noise_rad_s_rthz) * dt};
  WatchTilt(stamp_ns);
  return moved;
}

void InertialNavigator::Start(StampNs stamp_ns, const ScanObservation& observation) {
  // Level by the quiet stretch that holds this stamp, else by the moment.
  const bool first = !last_known_;
  std::size_t begin = FirstFrom(stamp_ns - 100'000'000);
  std::size_t end = FirstFrom(stamp_ns + 100'000'000);
  double tilt_sigma = 0.06;
  for (const SampleRange& range : quiet_) {
    if (imu_[range.begin].stamp_ns > stamp_ns || imu_[range.end - 1].stamp_ns < stamp_ns) continue;
    begin = range.begin;
    end = range.end;
    tilt_sigma = 0.03;
  }
  const std::optional<Levelling> here = Level(std::span(imu_).subspan(begin, end - begin));
  if (!here) return;

  InertialState state;
  double gyro_sigma = first ? options_.noise.gyro_bias_sigma_rad_s : 5e-4;
  if (last_known_) {
    state.gyro_bias = last_known_->gyro_bias;
    state.accelerometer_bias = last_known_->accelerometer_bias;
  } else if (!quiet_.empty()) {
    // The longest quiet stretch on a mark, else the longest: it may be an even turn, so it is believed less.
    const auto length = [&](const SampleRange& r) {
      const StampNs middle = (imu_[r.begin].stamp_ns + imu_[r.end - 1].stamp_ns) / 2;
      return Seconds(imu_[r.end - 1].stamp_ns - imu_[r.begin].stamp_ns) + (OnMark(middle) ? 1e6 : 0.0);
    };
    const SampleRange best = *std::max_element(quiet_.begin(), quiet_.end(),
                                               [&](const auto& a, const auto& b) { return length(a) < length(b); });
    if (const auto rest = Level(std::span(imu_).subspan(best.begin, best.end - best.begin))) {
      state.gyro_bias = rest->mean_rate_in_body;
      gyro_sigma = length(best) > 1e6 ? 1e-3 : 5e-3;
    }
  }
  const Pose2& mounting = session_.setup.body_from_lidar;
  const Pose2 body = observation.local_from_scan * Inverse(mounting);
  state.local_from_body = Eigen::Quaterniond(Eigen::AngleAxisd(body.theta, Vector3d::UnitZ())) * here->level_from_body;
  const Eigen::Vector2d v_lidar =
      Rotation2(observation.local_from_scan.theta) * Eigen::Vector2d(observation.twist.vx, observation.twist.vy);
  const Vector3d offset = state.local_from_body * LeverArm(mounting);
  state.p_in_local = Vector3d(observation.local_from_scan.x, observation.local_from_scan.y, 0.0) -
                     Vector3d(offset.x(), offset.y(), 0.0);
  state.v_in_local = Vector3d(v_lidar.x(), v_lidar.y(), 0.0) -
                     Vector3d(0, 0, observation.twist.omega).cross(Vector3d(offset.x(), offset.y(), 0.0));
  const Matrix3d pose =
      Vector3d(Square(options_.match_sigma_m), Square(options_.match_sigma_m), Square(options_.match_sigma_rad))
          .asDiagonal();
  filter_.emplace(state,
                  StartCovariance(tilt_sigma, 0.5, gyro_sigma, options_.noise.accelerometer_bias_sigma_m_s2, pose),
                  options_.noise, earth_);
  now_ = SampleAt(stamp_ns);
  next_ = FirstFrom(stamp_ns + 1);
  time_ns_ = step_ns_ = stamp_ns;
  turned_since_step_.setZero();
  last_lidar_ = LidarPose(state);
  summary_.restarts += first ? 0 : 1;
  const PackedCovariance packed(filter_->covariance());
  Keep({stamp_ns, false, {}, state, packed, state, packed});
}

bool InertialNavigator::OnMark(StampNs stamp_ns) const {
  return std::any_of(session_.marks.begin(), session_.marks.end(), [&](const Mark& mark) {
    return stamp_ns > mark.start_ns + kMarkMargin && stamp_ns < mark.end_ns - kMarkMargin;
  });
}

void InertialNavigator::UpdateByOdometry(StampNs stamp_ns, StampNs lead_ns) {
  const std::optional<Pose2> from = odometry_.At(step_ns_ - lead_ns);
  const std::optional<Pose2> to = odometry_.At(stamp_ns - lead_ns);
  if (!from || !to) return;
  const double dt = Seconds(stamp_ns - step_ns_);
  if (dt > kLongestMeanVelocity_s) return;
  const Eigen::Vector2d v = Between(*from, *to).Translation() / dt;
  filter_->UpdateBodyVelocity(v, options_.odometry_sigma_m_s + options_.odometry_sigma_per_m_s * v.norm());
}

void InertialNavigator::UpdateByStandstill(StampNs stamp_ns) {
  constexpr double kStill_rad_s = 0.03;
  const double dt = Seconds(stamp_ns - step_ns_);
  const Vector3d rate = turned_since_step_ / dt;
  if (!OnMark(step_ns_) || !OnMark(stamp_ns) || (rate - filter_->state().gyro_bias).norm() > kStill_rad_s) return;
  filter_->UpdateStandstill(options_.standstill_sigma_m_s, rate, dt);
}

void InertialNavigator::FeedStep(StampNs stamp_ns, const ScanObservation& observation,
                                 const ErrorTransition& transition) {
  const InertialState predicted = filter_->state();
  const PackedCovariance predicted_covariance(filter_->covariance());
  filter_->UpdateLevelVelocity(options_.level_sigma_m_s);
  UpdateByOdometry(stamp_ns, observation.odometry_lead_ns);
  UpdateByStandstill(stamp_ns);
  if (observation.matched) {
    Matrix3d covariance = observation.covariance;
    covariance.diagonal() +=
        Vector3d(Square(options_.match_sigma_m), Square(options_.match_sigma_m), Square(options_.match_sigma_rad));
    const Pose2& mounting = session_.setup.body_from_lidar;
    if (filter_->UpdatePlanarPose(observation.local_from_scan, covariance, mounting)) {
      contradicted_s_ = 0.0;
    } else {
      contradicted_s_ += Seconds(stamp_ns - step_ns_);
    }
  }
  if (contradicted_s_ > kContradictionLimit_s) {
    summary_.doubts.push_back(
        {InertialDoubt::Cause::kContradicted, stamp_ns - static_cast<StampNs>(1e9 * contradicted_s_), contradicted_s_});
    last_known_ = filter_->state();
    --summary_.restarts;  // no gap
    Start(stamp_ns, observation);
    contradicted_s_ = 0.0;
    return;
  }
  Keep({stamp_ns, true, transition, predicted, predicted_covariance, filter_->state(),
        PackedCovariance(filter_->covariance())});
  step_ns_ = stamp_ns;
  turned_since_step_.setZero();
}

void InertialNavigator::Observe(StampNs stamp_ns, const ScanObservation& observation) {
  if (imu_.empty()) return;
  if (!filter_) {
    if (Covers(stamp_ns)) Start(stamp_ns, observation);
    return;
  }
  if (Seconds(stamp_ns - step_ns_) >= options_.update_interval_s)
    FeedStep(stamp_ns, observation, filter_->PropagateCovariance());
  if (filter_) last_lidar_ = LidarPose(filter_->state());
}

// Of a long drive the beginning is smoothed, and its steps are let go, as soon as so many more have been seen that what
// follows tells nothing of it.
void InertialNavigator::Keep(const FilterStep& step) {
  const std::size_t piece = 4 * options_.look_ahead;  // large against what is smoothed twice
  steps_.push_back(step);
  if (steps_.size() < piece + options_.look_ahead) return;
  SmoothFirst(piece, &smoothed_);
  steps_.erase(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(piece));
}

void InertialNavigator::SmoothFirst(std::size_t num_steps, Smoothing* smoothing) const {
  const std::size_t first = smoothing->corrections.size();
  smoothing->corrections.resize(first + num_steps);
  Smooth(steps_, [&](std::size_t k, const InertialState& state, const ErrorMatrix& covariance) {
    if (k >= num_steps) return;
    smoothing->gyro_bias += state.gyro_bias;
    smoothing->accelerometer_bias += state.accelerometer_bias;
    SmoothedCorrection& correction = smoothing->corrections[first + k];
    correction.stamp_ns = steps_[k].stamp_ns;
    correction.continues = steps_[k].continues;
    correction.filtered_from_smoothed = Between(LidarPose(steps_[k].updated), LidarPose(state));
    const auto design = PlanarPoseDesign(state, session_.setup.body_from_lidar);
    correction.covariance = design * covariance * design.transpose();
  });
}

std::vector<SmoothedCorrection> InertialNavigator::Smoothed(InertialSummary* summary) const {
  *summary = summary_;
  if (tilted_) summary->doubts.push_back(*tilted_);
  Smoothing all = smoothed_;
  SmoothFirst(steps_.size(), &all);
  const auto count = static_cast<double>(std::max<std::size_t>(all.corrections.size(), 1));
  summary->gyro_bias = all.gyro_bias / count;
  summary->accelerometer_bias = all.accelerometer_bias / count;
  return std::move(all.corrections);
}

}  // namespace survey
