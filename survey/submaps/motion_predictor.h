// SPDX-License-Identifier: Apache-2.0
//
// Where the lidar will be at the next scan, from the motion since the last one: by the IMU, by wheel odometry and by
// constant velocity, each weighted by how well it foretold the last matches. Wheels that slip, drift or answer late
// lose their weight; where the odometry leads or lags the laser, the lead is estimated from the turns of both.
#pragma once

#include <optional>
#include <vector>

#include "survey/inertial/navigator.h"
#include "survey/sensors/odometry_track.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/track.h"

namespace survey {

// A-priori uncertainty of a predicted motion, before matches have told more: sigma = base + per metre * path + per
// radian * turn.
struct MotionNoise {
  double sigma_m = 0.02;
  double sigma_m_per_m = 0.10;
  double sigma_rad = 0.01;
  double sigma_rad_per_rad = 0.15;
  double sigma_rad_per_m = 0.02;
  double acceleration_m_s2 = 0.5;  // of the constant-velocity model
  double acceleration_rad_s2 = 1.5;
  double sigma_inertial_rad = 0.002;  // beside what the IMU itself says
  double max_odometry_gap_s = 0.5;
};

// A predicted pose with its covariance, both in the local frame.
struct PredictedPose {
  Pose2 local_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  Twist2 twist;  // of the lidar during the scan
  Prediction source = Prediction::kStart;
  Eigen::Matrix2d level_from_lidar = Eigen::Matrix2d::Identity();  // projects the scan to the horizontal
};

// Delay of the odometry against the laser: the odometry at stamp t - lead shows the motion of the laser at t. Found by
// comparing the turns of matched scans with those of the odometry at a series of delays.
class OdometryLead {
 public:
  OdometryLead(const OdometryTrack& odometry);
  void Add(StampNs from_ns, StampNs to_ns, double matched_turn_rad);
  StampNs lead_ns() const { return lead_ns_; }

 private:
  const OdometryTrack& odometry_;
  std::vector<StampNs> leads_;
  std::vector<double> squares_;                  // by lead: sum of the squared differences of turns, rad2
  std::vector<std::optional<double>> headings_;  // by lead: of the odometry at the last stamp
  double excitation_ = 0.0;                      // sum of squared turns, rad2
  StampNs last_ns_ = 0;
  StampNs lead_ns_ = 0;
};

class MotionPredictor {
 public:
  // Keeps a reference to the session.
  MotionPredictor(const Session& session, const MotionNoise& noise, const InertialOptions& inertial = {});

  // Pose of the scan with this stamp; the first scan is the origin.
  PredictedPose Predict(StampNs stamp_ns);

  // What came of the prediction: stamps in the order of Predict.
  void Update(StampNs stamp_ns, const Pose2& local_from_scan, const Eigen::Matrix3d& covariance, bool matched);

  // Negative where the odometry lags.
  double odometry_lead_s() const { return Seconds(lead_.lead_ns()); }
  const InertialNavigator& navigator() const { return navigator_; }

 private:
  // Exponentially weighted mean squares of what a source got wrong.
  struct Innovations {
    double square_m = 0.0;
    double square_rad = 0.0;
    void Add(const Pose2& predicted_from_matched);
  };
  struct Source {
    std::optional<Pose2> motion;  // from the last scan to the one that is predicted
    Innovations innovations;
  };
  // What a source knows of the motion: variances of its translation (m2) and rotation (rad2).
  struct Estimate {
    const Pose2* motion;
    double variance_m;
    double variance_rad;
  };
  double EvenSpan(StampNs stamp_ns) const;
  std::vector<Estimate> Estimates(double dt) const;
  PredictedPose Fuse(double dt) const;

  const SensorSetup& setup_;
  MotionNoise noise_;
  OdometryTrack odometry_;
  OdometryLead lead_;
  InertialNavigator navigator_;
  std::optional<InertialMotion> inertial_motion_;
  Source inertial_;
  Source wheels_;
  Source velocity_;
  Innovations fused_;
  bool started_ = false;
  Pose2 last_pose_;
  Pose2 predicted_pose_;
  Twist2 last_twist_;
  StampNs last_stamp_ns_ = 0;
  double mean_span_s_ = 0.0;  // between scans, exponentially weighted
};

}  // namespace survey
