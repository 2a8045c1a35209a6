// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/scan_points.h"

#include <algorithm>

namespace survey {

Twist2 TwistBetween(const Pose2& frame_from_a, const Pose2& frame_from_b, double dt_s) {
  if (!(dt_s > 0.0)) return {};
  const Pose2 motion = Between(frame_from_a, frame_from_b);
  return {motion.x / dt_s, motion.y / dt_s, motion.theta / dt_s};
}

ScanProjector::ScanProjector(std::span<const ScanGeometry> geometries, double max_range_m, double free_range_m)
    : max_range_m_(static_cast<float>(max_range_m)),
      free_range_m_(static_cast<float>(std::min(free_range_m, max_range_m))) {
  for (const ScanGeometry& geometry : geometries) {
    Directions directions{geometry, {}};
    for (int i = 0; i < geometry.num_beams; ++i) {
      const double angle = geometry.angle_min_rad + i * geometry.angle_increment_rad;
      directions.unit.emplace_back(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    }
    directions_.push_back(std::move(directions));
  }
}

void ScanProjector::Project(const Session& session, std::size_t scan, const Twist2& twist, ScanPoints* points,
                            const Eigen::Matrix2d& level_from_lidar) const {
  const std::span<const float> ranges_m = RangesOf(session, scan, &points->ranges_m);
  Project(session.scans[scan].geometry, ranges_m, twist, points, level_from_lidar);
}

void ScanProjector::Project(int geometry, std::span<const float> ranges_m, const Twist2& twist, ScanPoints* points,
                            const Eigen::Matrix2d& level_from_lidar) const {
  const Eigen::Matrix2f level = level_from_lidar.cast<float>();
  const bool tilted = !level_from_lidar.isIdentity(0.0);
  points->hits.clear();
  points->free_ends.clear();
  const Directions& directions = directions_[static_cast<std::size_t>(geometry)];
  const auto dt = static_cast<float>(directions.geometry.time_increment_s);
  const bool skewed = dt > 0.0F && (twist.vx != 0.0 || twist.vy != 0.0 || twist.omega != 0.0);
  const auto vx = static_cast<float>(twist.vx);
  const auto vy = static_cast<float>(twist.vy);
  const auto omega = static_cast<float>(twist.omega);
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const float range = ranges_m[i];
    if (std::isnan(range)) continue;
    const bool hit = range <= max_range_m_;
    const float reach = hit ? range : free_range_m_;
    if (!(reach > 0.0F)) continue;
    Eigen::Vector2f p = reach * directions.unit[i];
    if (tilted) p = level * p;
    if (skewed) {  // the beam left t after the stamp, from a lidar that had moved by the twist (second order)
      const float t = dt * static_cast<float>(i);
      const float angle = omega * t;
      const float cosine = 1.0F - 0.5F * angle * angle;
      p = Eigen::Vector2f(cosine * p.x() - angle * p.y() + vx * t, cosine * p.y() + angle * p.x() + vy * t);
    }
    (hit ? points->hits : points->free_ends).push_back(p);
  }
}

void ThinAlongScan(std::span<const Eigen::Vector2f> points, double spacing_m, std::size_t max_points,
                   std::vector<Eigen::Vector2f>* thinned) {
  for (auto spacing = static_cast<float>(spacing_m);; spacing *= 1.4142135F) {
    thinned->clear();
    const float square = spacing * spacing;
    for (const Eigen::Vector2f& p : points) {
      if (thinned->empty() || (p - thinned->back()).squaredNorm() >= square) thinned->push_back(p);
    }
    if (thinned->size() <= max_points) return;
  }
}

void SurfacePoints(std::span<const Eigen::Vector2f> hits, double spacing_m, double max_gap_m,
                   std::vector<Eigen::Vector2f>* surface) {
  surface->clear();
  const auto spacing = static_cast<float>(spacing_m);
  const auto max_gap = static_cast<float>(max_gap_m);
  constexpr float kMaxSine = 0.35F;
  const auto in_line = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
    const float cross = a.x() * b.y() - a.y() * b.x();
    return a.dot(b) > 0.0F && cross * cross < kMaxSine * kMaxSine * a.squaredNorm() * b.squaredNorm();
  };
  for (std::size_t i = 1; i < hits.size(); ++i) {
    const Eigen::Vector2f step = hits[i] - hits[i - 1];
    const float gap = step.norm();
    if (gap <= spacing || gap > max_gap) continue;
    const bool straight = (i >= 2 && in_line(hits[i - 1] - hits[i - 2], step)) ||
                          (i + 1 < hits.size() && in_line(step, hits[i + 1] - hits[i]));
    if (!straight) continue;
    const int pieces = static_cast<int>(std::ceil(gap / spacing));
    for (int k = 1; k < pieces; ++k)
      surface->push_back(hits[i - 1] + step * (static_cast<float>(k) / static_cast<float>(pieces)));
  }
}

}  // namespace survey
