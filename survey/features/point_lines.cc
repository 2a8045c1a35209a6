// SPDX-License-Identifier: Apache-2.0
#include "survey/features/point_lines.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "survey/accuracy/moments.h"
#include "survey/features/feature.h"
#include "survey/geometry/principal_axes.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSamples = 300;
constexpr int kMaxLines = 8;
constexpr double kMinFace_m = 0.12;

std::vector<Vector2d> NearLine(const std::vector<Vector2d>& points, const Vector2d& on, const Vector2d& normal,
                               double tolerance) {
  std::vector<Vector2d> near;
  for (const Vector2d& p : points) {
    if (std::abs(normal.dot(p - on)) <= tolerance) near.push_back(p);
  }
  return near;
}

// Total least squares.
PointLine FitLine(const std::vector<Vector2d>& points) {
  PointLine line{.middle = MeanOf(points)};
  const PrincipalAxes principal = PrincipalAxesOf(SecondMomentAboutMean(points));
  line.normal = principal.axes.col(0);
  line.spread = std::sqrt(std::max(0.0, principal.values[1]));
  const double degrees_of_freedom = std::max(1.0, static_cast<double>(points.size()) - 2.0);
  line.sigma_offset = std::sqrt(std::max(0.0, principal.values[0]) / degrees_of_freedom);
  for (const Vector2d& p : points) {
    line.half_length = std::max(line.half_length, std::abs(line.Along().dot(p - line.middle)));
  }
  return line;
}

std::vector<Vector2d> BestLine(const std::vector<Vector2d>& points, double tolerance, std::uint32_t stream) {
  const RandomStream random(StreamOfName("reference lines"), 0, stream);
  std::vector<Vector2d> best;
  for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
    const auto bits = random.Bits(sample);
    const Vector2d& a = points[bits[0] % points.size()];
    const Vector2d d = points[bits[1] % points.size()] - a;
    if (d.norm() < 0.05) continue;
    std::vector<Vector2d> near = NearLine(points, a, Vector2d(-d.y(), d.x()).normalized(), tolerance);
    if (near.size() > best.size()) best = std::move(near);
  }
  return best;
}

bool Meet(const PointLine& a, const PointLine& b) {
  return std::abs(a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x()) >= kMinSineOfCorner;
}

// Each face fitted anew to points that no other face could have drawn: those about a corner would tilt it.
void FitApart(const std::vector<Vector2d>& points, const PointLineOptions& options, std::vector<PointLine>* lines) {
  const std::vector<PointLine> rough = *lines;
  for (PointLine& line : *lines) {
    std::vector<Vector2d> members;
    for (const Vector2d& p : points) {
      const bool shared = std::any_of(rough.begin(), rough.end(), [&](const PointLine& other) {
        return Meet(line, other) && other.DistanceTo(p) <= 2.0 * options.tolerance_m;
      });
      if (!shared && line.DistanceTo(p) <= options.tolerance_m) members.push_back(p);
    }
    if (static_cast<int>(members.size()) >= options.min_points) line = FitLine(members);
  }
}

}  // namespace

double PointLine::SigmaAt(const Vector2d& p) const {
  return sigma_offset * std::hypot(1.0, Along().dot(p - middle) / spread);
}

std::vector<PointLine> FindPointLines(const std::vector<Vector2d>& all, const PointLineOptions& options) {
  std::vector<PointLine> lines;
  std::vector<Vector2d> points = all;
  for (std::uint32_t i = 0; i < kMaxLines && static_cast<int>(points.size()) >= options.min_points; ++i) {
    const std::vector<Vector2d> members = BestLine(points, options.tolerance_m, i);
    if (static_cast<int>(members.size()) < options.min_points) break;
    const PointLine line = FitLine(members);
    std::erase_if(points, [&](const Vector2d& p) { return line.DistanceTo(p) <= 1.5 * options.tolerance_m; });
    if (2.0 * line.half_length >= kMinFace_m) lines.push_back(line);
  }
  for (int round = 0; round < 2; ++round) FitApart(all, options, &lines);
  return lines;
}

std::optional<PointCrossing> CrossingOf(const PointLine& a, const PointLine& b) {
  if (!Meet(a, b)) return std::nullopt;
  Eigen::Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  const Eigen::Matrix2d inverse = normals.inverse();
  const Vector2d p = inverse * Vector2d(a.normal.dot(a.middle), b.normal.dot(b.middle));
  const Vector2d variances(std::pow(a.SigmaAt(p), 2), std::pow(b.SigmaAt(p), 2));
  return PointCrossing{p, inverse * variances.asDiagonal() * inverse.transpose()};
}

}  // namespace survey
