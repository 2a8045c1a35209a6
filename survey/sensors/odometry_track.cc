// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/odometry_track.h"

#include <algorithm>
#include <limits>

namespace survey {

std::optional<Pose2> OdometryTrack::At(StampNs stamp_ns) const {
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), stamp_ns,
                       [](const OdometrySample& sample, StampNs stamp) { return sample.stamp_ns < stamp; });
  const double to_after =
      after == samples_.end() ? std::numeric_limits<double>::max() : Seconds(after->stamp_ns - stamp_ns);
  const double from_before =
      after == samples_.begin() ? std::numeric_limits<double>::max() : Seconds(stamp_ns - (after - 1)->stamp_ns);
  if (to_after + from_before <= max_gap_s_) {
    return Interpolate((after - 1)->odom_from_body, after->odom_from_body, from_before / (from_before + to_after));
  }
  if (std::min(to_after, from_before) > max_gap_s_) return std::nullopt;
  return (to_after < from_before ? after : after - 1)->odom_from_body;
}

std::optional<Pose2> OdometryTrack::LidarMotion(StampNs from_ns, StampNs to_ns, const Pose2& body_from_lidar) const {
  const std::optional<Pose2> from = At(from_ns);
  const std::optional<Pose2> to = At(to_ns);
  if (!from || !to) return std::nullopt;
  return Inverse(body_from_lidar) * Between(*from, *to) * body_from_lidar;
}

}  // namespace survey
