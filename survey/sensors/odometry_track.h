// SPDX-License-Identifier: Apache-2.0
//
// Wheel odometry as a function of time: the body's pose in the odometry frame, interpolated between samples.
#pragma once

#include <optional>
#include <span>

#include "survey/sensors/session.h"

namespace survey {

class OdometryTrack {
 public:
  // Samples in order of their stamps; kept by reference. Gaps longer than max_gap_s are not interpolated: the nearest
  // sample stands for max_gap_s on either side.
  OdometryTrack(std::span<const OdometrySample> samples, double max_gap_s) : samples_(samples), max_gap_s_(max_gap_s) {}

  // odom_from_body at a stamp; empty farther than max_gap_s from all samples. Queries that move forward in time are
  // fastest.
  std::optional<Pose2> At(StampNs stamp_ns) const;

  // Motion of the lidar from one stamp to another: lidar at `from`  <-  lidar at `to`.
  std::optional<Pose2> LidarMotion(StampNs from_ns, StampNs to_ns, const Pose2& body_from_lidar) const;

 private:
  std::span<const OdometrySample> samples_;
  double max_gap_s_;
};

}  // namespace survey
