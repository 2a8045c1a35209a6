// SPDX-License-Identifier: Apache-2.0
//
// Inertial navigation of a block beside the scan matcher (DESIGN section 6): mechanizes the IMU from scan to scan,
// learns velocity, tilt and biases from the matches, from odometry and from standing on marks, and foretells the motion
// to the next scan. Where the IMU is missing for longer than a few samples it says so and starts anew behind the gap.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "survey/inertial/alignment.h"
#include "survey/inertial/error_state_filter.h"
#include "survey/inertial/smoother.h"
#include "survey/sensors/odometry_track.h"
#include "survey/sensors/scan_points.h"
#include "survey/sensors/session.h"

namespace survey {

struct InertialOptions {
  bool use = true;
  double latitude_rad = 0.87;  // for gravity and the Earth's rotation: half a degree is a thousandth of gravity's bias
  InertialNoise noise;
  double match_sigma_m = 0.01;  // of a match, at least: what neighbouring matches share
  double match_sigma_rad = 0.003;
  double update_interval_s = 0.1;  // matches in between are not used: they tell the same
  double max_gap_s = 0.1;          // between samples
  std::size_t look_ahead = 500;    // updates that are awaited behind a stretch before it is smoothed
  double level_sigma_m_s = 0.1;    // of the vertical velocity
  double standstill_sigma_m_s = 0.01;
  double odometry_sigma_m_s = 0.05;     // of a velocity by odometry ...
  double odometry_sigma_per_m_s = 0.1;  // ... and of its scale
  double max_tilt_rad = 0.26;           // beyond, the platform is no cart on a floor
};

// From the last scan to this one.
struct InertialMotion {
  Pose2 motion;                                         // lidar then <- lidar now
  Eigen::Vector2d variances = Eigen::Vector2d::Zero();  // of its translation per axis (m2) and rotation (rad2)
  Twist2 twist;                                         // of the lidar during the sweep that begins now
  Eigen::Matrix2d level_from_lidar = Eigen::Matrix2d::Identity();  // projects points of the scan to the horizontal
};

// What came of a scan, in the local frame.
struct ScanObservation {
  Pose2 local_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool matched = false;
  Twist2 twist;  // since the last scan
  StampNs odometry_lead_ns = 0;
};

// Where the IMU doubts the track.
struct InertialDoubt {
  enum class Cause { kTilted, kContradicted };
  Cause cause = Cause::kTilted;
  StampNs stamp_ns = 0;  // where it begins
  double value = 0.0;    // largest tilt (rad); how long (s)
};

struct InertialSummary {
  int restarts = 0;                                              // after gaps
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           // smoothed mean, rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  // m/s2
  std::vector<InertialDoubt> doubts;                             // in order of their causes' ends
};

// Where the smoothed trajectory lies against the one that was filtered, at one scan.
struct SmoothedCorrection {
  StampNs stamp_ns = 0;
  bool continues = false;                                // from the one before; false behind a gap
  Pose2 filtered_from_smoothed;                          // of the lidar
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of the smoothed pose in the local frame
};

class InertialNavigator {
 public:
  // Keeps a reference to the session.
  InertialNavigator(const Session& session, const InertialOptions& options);

  // Moves on to a scan's stamp; empty while there is no IMU. Every Advance is followed by Observe with the same stamp.
  std::optional<InertialMotion> Advance(StampNs stamp_ns);
  void Observe(StampNs stamp_ns, const ScanObservation& observation);

  // At the end of the block: smooths, fills the summary.
  std::vector<SmoothedCorrection> Smoothed(InertialSummary* summary) const;

 private:
  bool Covers(StampNs stamp_ns) const;
  ImuSample SampleAt(StampNs stamp_ns) const;
  bool MechanizeTo(StampNs stamp_ns);
  void Start(StampNs stamp_ns, const ScanObservation& observation);
  void FeedStep(StampNs stamp_ns, const ScanObservation& observation, const ErrorTransition& transition);
  void UpdateByOdometry(StampNs stamp_ns, StampNs lead_ns);
  void UpdateByStandstill(StampNs stamp_ns);
  void WatchTilt(StampNs stamp_ns);
  bool OnMark(StampNs stamp_ns) const;
  // What is known of a stretch of the drive when all behind it has been seen.
  struct Smoothing {
    std::vector<SmoothedCorrection> corrections;
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  // sums
    Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();
  };
  void Keep(const FilterStep& step);
  void SmoothFirst(std::size_t num_steps, Smoothing* smoothing) const;
  Pose2 LidarPose(const InertialState& state) const;
  Twist2 LidarTwist(StampNs stamp_ns) const;
  std::size_t FirstFrom(StampNs stamp_ns) const;

  const Session& session_;
  InertialOptions options_;
  Earth earth_;
  std::vector<ImuSample> imu_;  // usable samples
  std::vector<SampleRange> quiet_;
  OdometryTrack odometry_;
  StampNs sweep_ns_ = 0;
  std::optional<ErrorStateFilter> filter_;   // while there is an IMU
  std::optional<InertialState> last_known_;  // biases survive a gap
  std::size_t next_ = 0;                     // first sample behind `time_ns_`
  StampNs time_ns_ = 0;
  ImuSample now_;  // at time_ns_
  Pose2 last_lidar_;
  StampNs step_ns_ = 0;                                          // of the last step
  Eigen::Vector3d turned_since_step_ = Eigen::Vector3d::Zero();  // integral of the raw rate, rad
  double contradicted_s_ = 0.0;                                  // how long the matches have been refused, s
  std::optional<InertialDoubt> tilted_;
  Smoothing smoothed_;
  FilterSteps steps_;  // behind those
  InertialSummary summary_;
};

}  // namespace survey
