// SPDX-License-Identifier: Apache-2.0
// Segments in the plane.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace survey {

/// Area of the parallelogram of a and b, positive when b lies to the left of a.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// From p to the nearest point of the segment from a to b; same unit as theirs.
inline double DistanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double length2 = d.squaredNorm();
  const double fraction = length2 > 0.0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (a + fraction * d - p).norm();
}

}  // namespace survey
