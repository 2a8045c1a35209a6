// SPDX-License-Identifier: Apache-2.0
//
// What the front end (`track`) knows of a block, in the block's local frame: a right-handed plane, metres, its origin
// at the lidar of the first scan. Nothing here depends on control. [CN] section 2.2-2.3, [Hess16] section IV.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <string>
#include <string_view>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace survey {

// Index of a scan in its session.
struct ScanId {
  int value = -1;
  auto operator<=>(const ScanId&) const = default;
};

/// Of a scan among those of its session, and back.
inline std::size_t IndexOf(ScanId scan) { return static_cast<std::size_t>(scan.value); }
inline ScanId IdOf(std::size_t scan) { return {static_cast<int>(scan)}; }

struct SubmapId {
  int value = -1;
  auto operator<=>(const SubmapId&) const = default;
};

// Where the prediction of a scan's pose came from.
enum class Prediction { kStart, kOdometry, kInertial, kConstantVelocity };

constexpr std::string_view Name(Prediction prediction) {
  switch (prediction) {
    case Prediction::kStart:
      return "start";
    case Prediction::kOdometry:
      return "odometry";
    case Prediction::kInertial:
      return "inertial";
    case Prediction::kConstantVelocity:
      return "constant velocity";
  }
  return "";
}

struct TrackedScan {
  ScanId scan;
  Pose2 local_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of the match in the submap: x, y (m), theta (rad)
  Prediction prediction = Prediction::kStart;
  bool matched = false;  // false: the prediction stands alone
  bool is_node = false;  // inserted into the submaps and carried by the back end
  float score = 0.0F;    // mean occupancy probability at the end points after matching, 0..1
};

// Rigid piece of map, drawn from its nodes. A node belongs to one or two submaps (they overlap by half).
struct Submap {
  SubmapId id;
  Pose2 local_from_submap;
  std::vector<ScanId> nodes;
};

// [CN] eq. (10): measured pose of a scan in a submap. Covariance in x, y (m), theta (rad) of the submap frame.
struct SubmapConstraint {
  SubmapId submap;
  ScanId scan;
  Pose2 submap_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

// Another pose that a scan may have.
struct RequestMode {
  Pose2 local_from_scan;
  double weight = 0.0;  // share of what speaks for it, 0..1
};

// A question for a person about one scan: where the front end doubts its pose.
struct ReviewRequest {
  ScanId scan;
  std::string cause;    // "odometry_only", "multimodal", "break", ...
  double doubt = 0.0;   // larger is worse
  std::string message;  // for people
  std::vector<RequestMode> modes;
};

// A place where the track may have come apart: what lies behind it may be displaced against what lies before.
struct TrackBreak {
  ScanId scan;          // the first one behind
  std::string message;  // for people
};

// By what the block was navigated from scan to scan, and what the IMU turned out to be.
struct NavigationSummary {
  double inertial_s = 0.0;  // by the IMU, with or without odometry beside it
  double odometry_s = 0.0;  // by odometry without IMU
  double constant_velocity_s = 0.0;
  double unmatched_s = 0.0;                                      // of all these: no scan match held the track
  int imu_restarts = 0;                                          // behind gaps of the IMU
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           // mean over the block, rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  // m/s2
};

// An occupation of a point, carried by one node: the mean of the scans that stood still on it.
struct TrackedMark {
  std::string point;
  StampNs start_ns = 0;
  StampNs end_ns = 0;
  ScanId scan;                                               // a node
  Eigen::Vector2d mark_in_scan = Eigen::Vector2d::Zero();    // the marked place in the frame of that scan, m
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  // of that place (centring, matching noise), m2
};

struct Track {
  std::vector<TrackedScan> scans;             // one per scan of the session, in its order
  std::vector<TrackedMark> marks;             // in order of start
  std::vector<Submap> submaps;                // by id
  std::vector<SubmapConstraint> constraints;  // nodes in the submaps they were inserted into
  std::vector<ReviewRequest> requests;
  NavigationSummary navigation;
  double odometry_lead_s = 0.0;  // found while tracking, negative where the odometry lags; told, not kept
};

// The requests that are breaks.
std::vector<TrackBreak> BreaksOf(const Track& track);

// A constraint between a submap and a scan that are not neighbours in time.
struct Loop {
  SubmapConstraint constraint;
  double score = 0.0;  // mean occupancy probability at the end points, 0..1
  bool accepted = true;
  std::string reason;  // why not
};

struct Loops {
  std::vector<Loop> loops;
  int candidates_searched = 0;
};

}  // namespace survey
