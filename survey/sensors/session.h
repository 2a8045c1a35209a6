// SPDX-License-Identifier: Apache-2.0
//
// The field data of one block on one clock, in SI units: what `ingest` writes and every later stage reads.
// Frames: `body` is the platform (x forward, y left, z up); `lidar` the laser scanner, whose centre is set up over
// the control points; the pose of a scan is the pose of the lidar frame at the scan's reference stamp (first beam).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "survey/geometry/pose2.h"

namespace survey {

// Nanoseconds since the log's epoch (Unix time where the log has it). Exact, so that it can be a key.
using StampNs = std::int64_t;

inline double Seconds(StampNs ns) { return static_cast<double>(ns) * 1e-9; }

// Range of a beam that came back from nothing within the instrument's reach: the space up to there is free.
inline constexpr float kNoReturn = std::numeric_limits<float>::infinity();
// Range of a beam that tells nothing (blocked, dropped out, below range_min).
inline constexpr float kInvalidRange = std::numeric_limits<float>::quiet_NaN();

// How the beams of a scan lie. Beam i leaves at angle_min + i * angle_increment in the lidar frame,
// i * time_increment after the scan's stamp.
struct ScanGeometry {
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  double time_increment_s = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  int num_beams = 0;

  bool operator==(const ScanGeometry&) const = default;
};

struct Scan {
  StampNs stamp_ns = 0;
  int geometry = 0;             // index into Session::geometries
  std::vector<float> ranges_m;  // one per beam; kNoReturn, kInvalidRange
  StampNs clock_repair_ns = 0;  // stamp_ns minus the stamp that the raw log prints
};

struct ImuSample {
  StampNs stamp_ns = 0;
  Eigen::Vector3d angular_rate_in_body = Eigen::Vector3d::Zero();    // rad/s
  Eigen::Vector3d specific_force_in_body = Eigen::Vector3d::Zero();  // m/s2; z reads +g at rest
};

struct OdometrySample {
  StampNs stamp_ns = 0;
  Pose2 odom_from_body;
};

// One occupation of a point: the lidar centre (plus lever arm) stood on it from start to end.
struct Mark {
  std::string point;
  StampNs start_ns = 0;
  StampNs end_ns = 0;
};

// Mounting and noise of the platform's sensors.
struct SensorSetup {
  Pose2 body_from_lidar;                                    // m, rad
  Eigen::Vector2d mark_in_lidar = Eigen::Vector2d::Zero();  // lever arm: the marked point in the lidar frame, m
  double range_sigma_m = 0.03;                              // 1 sigma of one range
  double mark_sigma_m = 0.005;                              // centring error over a point, 1 sigma per axis
};

// Where the ranges of a session's scans lie when they are read one scan at a time: a drive of hours need not fit into
// memory.
class ScanRanges {
 public:
  virtual ~ScanRanges() = default;
  // Overwrites `ranges_m` with those of a scan, one per beam. May be called from several threads.
  virtual void Read(std::size_t scan, std::vector<float>* ranges_m) const = 0;
};

// Scans in order of their stamps; IMU and odometry likewise; both may be empty. At least one scan.
struct Session {
  SensorSetup setup;
  std::vector<ScanGeometry> geometries;
  std::vector<Scan> scans;
  std::shared_ptr<const ScanRanges> ranges;  // null: each scan holds its own; otherwise scans hold none
  std::vector<ImuSample> imu;
  std::vector<OdometrySample> odometry;
  std::vector<Mark> marks;
};

// One range per beam; lives as long as the session and the buffer, which may be overwritten.
std::span<const float> RangesOf(const Session& session, std::size_t scan, std::vector<float>* buffer);

// The stamps of a scan, kept beside its pose. They differ only where a faulty clock of the logging program was
// repaired.
struct ScanStamp {
  StampNs clock_ns = 0;     // on the block's clock, which grows from scan to scan
  StampNs recorded_ns = 0;  // as the raw log prints it: what other records of the drive refer to; exports use it

  bool operator==(const ScanStamp&) const = default;
};

std::vector<ScanStamp> StampsOfScans(const Session& session);

std::vector<StampNs> ClockStamps(const std::vector<ScanStamp>& stamps);

}  // namespace survey
