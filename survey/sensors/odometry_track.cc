// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/odometry_track.h"

#include <algorithm>

namespace survey {

std::optional<Pose2> OdometryTrack::At(StampNs stamp_ns) const {
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), stamp_ns,
                       [](const OdometrySample& sample, StampNs stamp) { return sample.stamp_ns < stamp; });
  const auto near = [&](const OdometrySample& sample) {
    return std::abs(Seconds(sample.stamp_ns - stamp_ns)) <= max_gap_s_;
  };
  if (after == samples_.end()) {
    if (samples_.empty() || !near(samples_.back())) return std::nullopt;
    return samples_.back().odom_from_body;
  }
  if (after->stamp_ns == stamp_ns) return after->odom_from_body;
  if (after == samples_.begin()) return near(*after) ? std::optional(after->odom_from_body) : std::nullopt;
  const auto before = after - 1;
  const double gap = Seconds(after->stamp_ns - before->stamp_ns);
  if (gap > max_gap_s_) return std::nullopt;
  return Interpolate(before->odom_from_body, after->odom_from_body, Seconds(stamp_ns - before->stamp_ns) / gap);
}

std::optional<Pose2> OdometryTrack::LidarMotion(StampNs from_ns, StampNs to_ns, const Pose2& body_from_lidar) const {
  const std::optional<Pose2> from = At(from_ns);
  const std::optional<Pose2> to = At(to_ns);
  if (!from || !to) return std::nullopt;
  return Inverse(body_from_lidar) * Between(*from, *to) * body_from_lidar;
}

}  // namespace survey
