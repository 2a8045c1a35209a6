// SPDX-License-Identifier: Apache-2.0
#include "survey/features/reference_pillar.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "survey/features/arc_share.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSamples = 300;
constexpr double kMinSize_m = 0.15;
constexpr double kMaxSize_m = 1.5;
constexpr double kParallelSine = 0.1;
constexpr double kCorner_m = 0.06;  // between the ends of faces that meet
constexpr int kRounds = 5;
constexpr double kMinArcShare = 0.4;
constexpr double kMinShareOnCircle = 0.8;  // of the points in and about it: a square has more outside

struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0.0;

  double DistanceTo(const Vector2d& p) const { return std::abs((p - centre).norm() - radius); }
};

std::optional<Circle> CircleThrough(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  Eigen::Matrix2d chords;
  chords << (b - a).transpose(), (c - a).transpose();
  if (std::abs(chords.determinant()) < 1e-6) return std::nullopt;
  const Vector2d right((b - a).squaredNorm() / 2, (c - a).squaredNorm() / 2);
  const Vector2d from_a = chords.inverse() * right;
  const Circle circle{a + from_a, from_a.norm()};
  if (2 * circle.radius < kMinSize_m || 2 * circle.radius > kMaxSize_m) return std::nullopt;
  return circle;
}

std::vector<Vector2d> OnCircle(const std::vector<Vector2d>& points, const Circle& circle, double tolerance) {
  std::vector<Vector2d> on;
  for (const Vector2d& p : points) {
    if (circle.DistanceTo(p) <= tolerance) on.push_back(p);
  }
  return on;
}

std::optional<Circle> BestCircle(const std::vector<Vector2d>& points, double tolerance) {
  const RandomStream random(StreamOfName("reference circles"), 0, 0);
  std::optional<Circle> best;
  std::size_t most = 0;
  for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
    const auto bits = random.Bits(sample);
    const auto circle = CircleThrough(points[bits[0] % points.size()], points[bits[1] % points.size()],
                                      points[bits[2] % points.size()]);
    if (!circle) continue;
    const std::size_t count = OnCircle(points, *circle, tolerance).size();
    if (count <= most) continue;
    most = count;
    best = circle;
  }
  return best;
}

// Distances to the circle made small, one step of Gauss-Newton; the covariance of centre and radius.
Eigen::Matrix3d Improve(const std::vector<Vector2d>& on, Circle* circle) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (const Vector2d& p : on) {
    const Vector2d out = p - circle->centre;
    const double residual = out.norm() - circle->radius;
    const Eigen::Vector3d row(out.x() / out.norm(), out.y() / out.norm(), 1.0);
    normal += row * row.transpose();
    right += residual * row;
    squares += residual * residual;
  }
  const Eigen::Matrix3d inverse = normal.inverse();
  const Eigen::Vector3d step = inverse * right;
  circle->centre += step.head<2>();
  circle->radius += step.z();
  return inverse * (squares / static_cast<double>(on.size() - 3));
}

std::optional<PointCrossing> RoundPillar(const std::vector<Vector2d>& points, const PointLineOptions& options) {
  std::optional<Circle> circle = BestCircle(points, options.tolerance_m);
  if (!circle) return std::nullopt;
  std::vector<Vector2d> on;
  Eigen::Matrix3d covariance;
  for (int round = 0; round < kRounds; ++round) {
    on = OnCircle(points, *circle, options.tolerance_m);
    if (static_cast<int>(on.size()) < 2 * options.min_points) return std::nullopt;
    covariance = Improve(on, &*circle);
  }
  const auto in_and_about = static_cast<double>(std::count_if(points.begin(), points.end(), [&](const Vector2d& p) {
    return (p - circle->centre).norm() <= circle->radius + kCorner_m;
  }));
  if (static_cast<double>(on.size()) < kMinShareOnCircle * in_and_about) return std::nullopt;
  if (ArcShare(on, circle->centre) < kMinArcShare) return std::nullopt;
  return PointCrossing{circle->centre, covariance.topLeftCorner<2, 2>()};
}

// The line in the middle of two faces, and how far they are apart.
struct Axis {
  PointLine line;
  double size = 0.0;
};

std::optional<Axis> AxisOf(const PointLine& a, const PointLine& b) {
  const double sine = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  const double distance = b.DistanceTo(a.middle);
  const double shift = std::abs(a.Along().dot(b.middle - a.middle));
  if (std::abs(sine) > kParallelSine || distance < kMinSize_m || distance > kMaxSize_m || shift > 0.5 * distance)
    return std::nullopt;
  Axis axis{a, distance};
  axis.line.middle = 0.5 * (a.middle + b.middle);
  axis.line.sigma_offset = 0.5 * std::hypot(a.sigma_offset, b.sigma_offset);
  return axis;
}

// What stands across the axis: its face, half a size before the centre. Empty where the face does not close the two of
// the axis, or those are longer than a square's.
std::optional<PointLine> CentreLineBy(const PointLine& face, const Axis& axis) {
  const double inward = face.normal.dot(axis.line.middle - face.middle);
  const bool closes = axis.line.DistanceTo(face.middle) <= kCorner_m &&
                      face.half_length <= 0.5 * axis.size + kCorner_m &&
                      std::abs(std::abs(inward) - axis.line.half_length) <= kCorner_m &&
                      2.0 * axis.line.half_length <= axis.size + kCorner_m;
  if (!closes) return std::nullopt;
  PointLine line = face;
  line.middle += std::copysign(0.5 * axis.size, inward) * face.normal;
  line.sigma_offset = std::hypot(face.sigma_offset, axis.line.sigma_offset);
  return line;
}

std::vector<Axis> AxesOf(const std::vector<PointLine>& lines) {
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      if (const std::optional<Axis> axis = AxisOf(lines[i], lines[j])) axes.push_back(*axis);
    }
  }
  return axes;
}

// Whether each pair of faces lies beside the middle of the other: not so where a face and what stands near are a pair.
bool ShareTheirMiddle(const Axis& a, const Axis& b) {
  return a.line.DistanceTo(b.line.middle) <= kCorner_m && b.line.DistanceTo(a.line.middle) <= kCorner_m;
}

std::vector<PointCrossing> PillarsOfFaces(const std::vector<PointLine>& lines) {
  const std::vector<Axis> axes = AxesOf(lines);
  std::vector<PointCrossing> centres;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      if (!ShareTheirMiddle(axes[i], axes[j])) continue;
      if (const auto centre = CrossingOf(axes[i].line, axes[j].line)) centres.push_back(*centre);
    }
  }
  if (!centres.empty()) return centres;
  for (const Axis& axis : axes) {
    for (const PointLine& face : lines) {
      const std::optional<PointLine> across = CentreLineBy(face, axis);
      const auto centre = across ? CrossingOf(axis.line, *across) : std::nullopt;
      if (centre) centres.push_back(*centre);
    }
  }
  return centres;
}

}  // namespace

std::vector<PointCrossing> FindPillars(const std::vector<Vector2d>& points, const PointLineOptions& options) {
  if (const std::optional<PointCrossing> round = RoundPillar(points, options)) return {*round};
  return PillarsOfFaces(FindPointLines(points, options));
}

}  // namespace survey
