// SPDX-License-Identifier: Apache-2.0
//
// Drawing maps from scans whose poses are known.
#pragma once

#include <span>
#include <vector>

#include "survey/grid/occupancy_pyramid.h"
#include "survey/sensors/scan_points.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

// Velocity of the lidar during scan i, from its pose and the next one (the one before at the end); zero across gaps.
// `pose_of` gives the pose of a scan by its index in any one frame.
template <typename PoseOf>
Twist2 TwistOfScan(const std::vector<Scan>& scans, const PoseOf& pose_of, std::size_t i) {
  constexpr double kMaxGap_s = 0.5;
  constexpr double kMinGap_s = 0.005;  // bursts of stamps give absurd velocities
  if (scans.size() < 2) return {};
  const std::size_t first = i + 1 < scans.size() ? i : i - 1;
  const double dt = Seconds(scans[first + 1].stamp_ns - scans[first].stamp_ns);
  if (dt < kMinGap_s || dt > kMaxGap_s) return {};
  return TwistBetween(pose_of(first), pose_of(first + 1), dt);
}

// Hits farther apart are not joined to a surface.
inline constexpr double kMaxSurfaceGap_m = 0.4;

// The submap's grid in its own frame, drawn from its nodes at their poses of the track.
OccupancyPyramid DrawSubmap(const Session& session, const Track& track, const Submap& submap,
                            const ScanProjector& projector, const OccupancyOptions& options);

// Points carried into another frame.
void TransformPoints(const Pose2& target_from_source, std::span<const Eigen::Vector2f> points,
                     std::vector<Eigen::Vector2f>* transformed);

}  // namespace survey
