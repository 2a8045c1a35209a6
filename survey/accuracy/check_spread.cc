// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/check_spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "survey/geometry/segment.h"

namespace survey {
namespace {

constexpr double kFewestInQuadrant = 0.2;

double DistanceToNearest(const Eigen::Vector2d& place, std::span<const Eigen::Vector2d> points) {
  double nearest = std::numeric_limits<double>::max();
  for (const Eigen::Vector2d& point : points) nearest = std::min(nearest, (point - place).norm());
  return nearest;
}

// One side of the hull of sorted points, without its last point (Andrew's monotone chain).
template <typename Iterator>
void AppendChain(Iterator begin, Iterator end, std::vector<Eigen::Vector2d>* hull) {
  const std::size_t start = hull->size();
  for (Iterator point = begin; point != end; ++point) {
    while (hull->size() >= start + 2 && Cross(hull->back() - (*hull)[hull->size() - 2], *point - hull->back()) <= 0.0) {
      hull->pop_back();
    }
    hull->push_back(*point);
  }
  hull->pop_back();
}

std::vector<double> QuadrantShares(std::span<const Eigen::Vector2d> checks, std::span<const Eigen::Vector2d> scans) {
  Eigen::Vector2d low = scans.front(), high = scans.front();
  for (const Eigen::Vector2d& scan : scans) {
    low = low.cwiseMin(scan);
    high = high.cwiseMax(scan);
  }
  std::vector<double> shares(4, 0.0);
  for (const Eigen::Vector2d& check : checks) {
    const Eigen::Vector2d d = check - 0.5 * (low + high);
    const std::size_t quadrant = d.y() >= 0 ? (d.x() >= 0 ? 0 : 1) : (d.x() < 0 ? 2 : 3);
    shares[quadrant] += 1.0 / static_cast<double>(checks.size());
  }
  return shares;
}

}  // namespace

double ConvexHullArea(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  if (points.size() < 3) return 0.0;
  std::vector<Eigen::Vector2d> hull;
  AppendChain(points.begin(), points.end(), &hull);
  AppendChain(points.rbegin(), points.rend(), &hull);
  double twice = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    twice += Cross(hull[i] - points.front(), hull[(i + 1) % hull.size()] - points.front());
  }
  return 0.5 * twice;
}

bool CheckSpread::Uneven() const {
  return std::any_of(quadrant_shares.begin(), quadrant_shares.end(),
                     [](double share) { return share < kFewestInQuadrant; });
}

std::optional<CheckSpread> DescribeSpread(std::span<const Eigen::Vector2d> checks,
                                          std::span<const Eigen::Vector2d> scans,
                                          std::span<const Eigen::Vector2d> control) {
  if (checks.empty() || scans.empty() || control.empty()) return std::nullopt;
  CheckSpread spread{.quadrant_shares = QuadrantShares(checks, scans)};
  const double mapped = ConvexHullArea({scans.begin(), scans.end()});
  if (mapped > 0.0) spread.hull_share = ConvexHullArea({checks.begin(), checks.end()}) / mapped;
  std::vector<double> distances;
  for (const Eigen::Vector2d& check : checks) distances.push_back(DistanceToNearest(check, control));
  std::sort(distances.begin(), distances.end());
  spread.nearest_control_min = distances.front();
  spread.nearest_control_median = 0.5 * (distances[(distances.size() - 1) / 2] + distances[distances.size() / 2]);
  spread.nearest_control_max = distances.back();
  return spread;
}

std::optional<FarFromControl> FindFarFromControl(std::span<const Eigen::Vector2d> path,
                                                 std::span<const Eigen::Vector2d> control, double limit_m) {
  FarFromControl far;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double distance = DistanceToNearest(path[i], control);
    if (distance <= limit_m) continue;
    if (i > 0) far.path_length += (path[i] - path[i - 1]).norm();
    if (distance > far.distance) far = {far.path_length, distance, path[i]};
  }
  return far.distance > 0.0 ? std::optional(far) : std::nullopt;
}

}  // namespace survey
