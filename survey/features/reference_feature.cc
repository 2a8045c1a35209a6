// SPDX-License-Identifier: Apache-2.0
#include "survey/features/reference_feature.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "survey/accuracy/moments.h"
#include "survey/features/feature.h"
#include "survey/geometry/principal_axes.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSamples = 300;
constexpr int kMaxLines = 8;
constexpr double kParallelSine = 0.1;
constexpr double kGap_m = 0.05;  // from the end of a face to the corner
constexpr double kMinFace_m = 0.12;
constexpr double kDistinct_m = 0.1;  // two corners must differ this much in their distance from the rough place

// A face: middle of its points, unit normal, half its length.
struct PointLine {
  Vector2d middle, normal;
  double half_length = 0.0;
  double sigma = 0.0;  // of the offset, m

  Vector2d Along() const { return {-normal.y(), normal.x()}; }
};

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
  line.sigma = std::sqrt(std::max(0.0, principal.values[0]) / static_cast<double>(points.size()));
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

double DistanceTo(const PointLine& line, const Vector2d& p) { return std::abs(line.normal.dot(p - line.middle)); }

bool Meet(const PointLine& a, const PointLine& b) {
  return std::abs(a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x()) >= kMinSineOfCorner;
}

// Each face fitted anew to points that no other face could have drawn: those about a corner would tilt it.
void FitApart(const std::vector<Vector2d>& points, const ReferenceFeatureOptions& options,
              std::vector<PointLine>* lines) {
  const std::vector<PointLine> rough = *lines;
  for (PointLine& line : *lines) {
    std::vector<Vector2d> members;
    for (const Vector2d& p : points) {
      const bool shared = std::any_of(rough.begin(), rough.end(), [&](const PointLine& other) {
        return Meet(line, other) && DistanceTo(other, p) <= 2.0 * options.tolerance_m;
      });
      if (!shared && DistanceTo(line, p) <= options.tolerance_m) members.push_back(p);
    }
    if (static_cast<int>(members.size()) >= options.min_points) line = FitLine(members);
  }
}

std::vector<PointLine> FindLines(const std::vector<Vector2d>& all, const ReferenceFeatureOptions& options) {
  std::vector<PointLine> lines;
  std::vector<Vector2d> points = all;
  for (std::uint32_t i = 0; i < kMaxLines && static_cast<int>(points.size()) >= options.min_points; ++i) {
    const std::vector<Vector2d> members = BestLine(points, options.tolerance_m, i);
    if (static_cast<int>(members.size()) < options.min_points) break;
    const PointLine line = FitLine(members);
    std::erase_if(points, [&](const Vector2d& p) { return DistanceTo(line, p) <= 1.5 * options.tolerance_m; });
    if (2.0 * line.half_length >= kMinFace_m) lines.push_back(line);
  }
  for (int round = 0; round < 2; ++round) FitApart(all, options, &lines);
  return lines;
}

struct PointCrossing {
  Vector2d p;
  Eigen::Matrix2d covariance;
};

std::optional<PointCrossing> Cross(const PointLine& a, const PointLine& b) {
  if (!Meet(a, b)) return std::nullopt;
  Eigen::Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  const Eigen::Matrix2d inverse = normals.inverse();
  const Vector2d p = inverse * Vector2d(a.normal.dot(a.middle), b.normal.dot(b.middle));
  const Vector2d variances(a.sigma * a.sigma, b.sigma * b.sigma);
  return PointCrossing{p, inverse * variances.asDiagonal() * inverse.transpose()};
}

bool ReachesTo(const PointLine& line, const Vector2d& p) {
  return std::abs(line.Along().dot(p - line.middle)) <= line.half_length + kGap_m;
}

// Places relative to the rough one.
void TakeNearest(std::vector<PointCrossing> candidates, const std::string& none, const ReferenceFeatureOptions& options,
                 const Vector2d& rough, MapFeature* feature) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PointCrossing& a, const PointCrossing& b) { return a.p.norm() < b.p.norm(); });
  if (candidates.empty() || candidates.front().p.norm() > options.search_radius_m) {
    feature->reason = none;
  } else if (candidates.size() > 1 && candidates[1].p.norm() - candidates[0].p.norm() < kDistinct_m) {
    feature->reason = "two of them lie about as near to the rough place";
  } else {
    feature->found = true;
    feature->position_in_site = rough + candidates.front().p;
    feature->covariance = candidates.front().covariance;
  }
}

std::vector<PointCrossing> Corners(const std::vector<PointLine>& lines) {
  std::vector<PointCrossing> corners;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      const std::optional<PointCrossing> crossing = Cross(lines[i], lines[j]);
      if (crossing && ReachesTo(lines[i], crossing->p) && ReachesTo(lines[j], crossing->p))
        corners.push_back(*crossing);
    }
  }
  return corners;
}

// The middle line of two faces that look apart.
std::optional<PointLine> Between(const PointLine& a, const PointLine& b) {
  const double sine = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  const double distance = std::abs(a.normal.dot(b.middle - a.middle));
  const double shift = std::abs(a.Along().dot(b.middle - a.middle));
  if (std::abs(sine) > kParallelSine || distance < 0.15 || distance > 1.5 || shift > 0.3) return std::nullopt;
  return PointLine{0.5 * (a.middle + b.middle), a.normal, a.half_length, 0.5 * std::hypot(a.sigma, b.sigma)};
}

std::vector<PointCrossing> SquareCentres(const std::vector<PointLine>& lines) {
  std::vector<PointLine> axes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      if (const std::optional<PointLine> axis = Between(lines[i], lines[j])) axes.push_back(*axis);
    }
  }
  std::vector<PointCrossing> centres;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      if (const std::optional<PointCrossing> crossing = Cross(axes[i], axes[j])) centres.push_back(*crossing);
    }
  }
  return centres;
}

// |p|^2 = 2 c.p + k by least squares, on points that lie near the circle of most of them.
std::optional<PointCrossing> RoundCentre(const std::vector<Vector2d>& points, const ReferenceFeatureOptions& options) {
  if (static_cast<int>(points.size()) < 2 * options.min_points) return std::nullopt;
  Eigen::MatrixX3d rows(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::VectorXd right(rows.rows());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vector2d& p = points[static_cast<std::size_t>(i)];
    rows.row(i) << 2.0 * p.x(), 2.0 * p.y(), 1.0;
    right[i] = p.squaredNorm();
  }
  const Eigen::Matrix3d normal = rows.transpose() * rows;
  const Eigen::Vector3d solution = normal.inverse() * (rows.transpose() * right);
  const Vector2d centre = solution.head<2>();
  const double radius = std::sqrt(solution.z() + centre.squaredNorm());
  double squares = 0.0;
  for (const Vector2d& p : points) squares += std::pow((p - centre).norm() - radius, 2);
  const double rms = std::sqrt(squares / static_cast<double>(points.size()));
  if (!(radius < 1.0) || rms > options.tolerance_m) return std::nullopt;
  const double variance = 2.0 * rms * rms / static_cast<double>(points.size());
  return PointCrossing{centre, Eigen::Matrix2d::Identity() * variance};
}

}  // namespace

MapFeature LocateInReference(std::span<const Vector2d> points, const NamedFeature& wanted,
                             const ReferenceFeatureOptions& options) {
  MapFeature feature{.name = wanted.name, .kind = wanted.kind};
  std::vector<Vector2d> near;
  for (const Vector2d& p : points) {
    const Vector2d d = p - wanted.position_in_site;
    if (d.norm() <= options.face_length_m) near.push_back(d);
  }
  feature.num_cells = static_cast<int>(near.size());
  if (feature.num_cells < options.min_points) {
    feature.reason = "the reference has too few points near";
    return feature;
  }
  const std::vector<PointLine> lines = FindLines(near, options);
  if (wanted.kind == FeatureKind::kCorner) {
    TakeNearest(Corners(lines), "no two faces meet near", options, wanted.position_in_site, &feature);
    return feature;
  }
  const std::optional<PointCrossing> round = RoundCentre(near, options);
  TakeNearest(round ? std::vector{*round} : SquareCentres(lines), "neither a circle nor four faces are seen", options,
              wanted.position_in_site, &feature);
  return feature;
}

}  // namespace survey
