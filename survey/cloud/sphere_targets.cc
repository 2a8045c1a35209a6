// SPDX-License-Identifier: Apache-2.0
#include "survey/cloud/sphere_targets.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector3d;
using Box = std::array<int, 3>;

constexpr int kSamples = 48;           // of four points in each box
constexpr double kLeastShare = 0.7;    // of the points around a centre that lie on the surface
constexpr double kLeastSpread = 0.08;  // smallest eigenvalue share of the directions seen: no flat patch

// Points by boxes of one radius.
std::map<Box, std::vector<Vector3d>> IntoBoxes(std::span<const Eigen::Vector3f> cloud, double size) {
  std::map<Box, std::vector<Vector3d>> boxes;
  for (const Eigen::Vector3f& point : cloud) {
    const Vector3d p = point.cast<double>();
    boxes[{static_cast<int>(std::floor(p.x() / size)), static_cast<int>(std::floor(p.y() / size)),
           static_cast<int>(std::floor(p.z() / size))}]
        .push_back(p);
  }
  return boxes;
}

std::vector<Vector3d> Around(const std::map<Box, std::vector<Vector3d>>& boxes, const Vector3d& centre, double size,
                             double reach) {
  std::vector<Vector3d> points;
  const auto steps = static_cast<int>(std::ceil(reach / size));
  const Eigen::Vector3i middle = (centre / size).array().floor().cast<int>();
  for (int x = -steps; x <= steps; ++x) {
    for (int y = -steps; y <= steps; ++y) {
      for (int z = -steps; z <= steps; ++z) {
        const auto box = boxes.find({middle.x() + x, middle.y() + y, middle.z() + z});
        if (box == boxes.end()) continue;
        for (const Vector3d& p : box->second) {
          if ((p - centre).norm() <= reach) points.push_back(p);
        }
      }
    }
  }
  return points;
}

// |p|^2 = 2 c.p + k through four points.
std::optional<Vector3d> CentreThrough(const std::array<Vector3d, 4>& points, const SphereSearchOptions& options) {
  Eigen::Matrix3d differences;
  Vector3d right;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = points[static_cast<std::size_t>(i) + 1] - points[0];
    differences.row(i) = 2.0 * d.transpose();
    right[i] = d.squaredNorm();
  }
  if (std::abs(differences.determinant()) < 1e-9) return std::nullopt;
  const Vector3d offset = differences.partialPivLu().solve(right);
  if (std::abs(offset.norm() - options.radius_m) > 3.0 * options.tolerance_m) return std::nullopt;
  return points[0] + offset;
}

std::vector<Vector3d> OnSurface(const std::vector<Vector3d>& points, const Vector3d& centre,
                                const SphereSearchOptions& options) {
  std::vector<Vector3d> found;
  for (const Vector3d& p : points) {
    if (std::abs((p - centre).norm() - options.radius_m) <= options.tolerance_m) found.push_back(p);
  }
  return found;
}

// Gauss-Newton on the distances from the surface, radius known.
Vector3d Refine(const std::vector<Vector3d>& points, Vector3d centre, double radius) {
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    for (const Vector3d& p : points) {
      const Vector3d direction = (p - centre).normalized();
      normal += direction * direction.transpose();
      right += direction * ((p - centre).norm() - radius);
    }
    centre += normal.ldlt().solve(right);
  }
  return centre;
}

bool SeenRound(const std::vector<Vector3d>& points, const Vector3d& centre) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += (p - centre).normalized() / static_cast<double>(points.size());
  for (const Vector3d& p : points) {
    const Vector3d d = (p - centre).normalized() - mean;
    moments += d * d.transpose() / static_cast<double>(points.size());
  }
  // The cap seen from one side spreads in two directions; a streak does not.
  return moments.trace() > kLeastSpread && moments.norm() < 0.95 * moments.trace();
}

std::optional<SphereTarget3> Measure(const std::map<Box, std::vector<Vector3d>>& boxes, Vector3d centre,
                                     const SphereSearchOptions& options) {
  std::vector<Vector3d> near, surface;
  for (int iteration = 0; iteration < 3; ++iteration) {
    near = Around(boxes, centre, options.radius_m, 1.25 * options.radius_m);
    surface = OnSurface(near, centre, options);
    if (static_cast<int>(surface.size()) < options.min_points) return std::nullopt;
    centre = Refine(surface, centre, options.radius_m);
  }
  const double share = static_cast<double>(surface.size()) / static_cast<double>(near.size());
  if (share < kLeastShare || !SeenRound(surface, centre)) return std::nullopt;
  double squares = 0.0;
  for (const Vector3d& p : surface) squares += std::pow((p - centre).norm() - options.radius_m, 2);
  return SphereTarget3{centre, std::sqrt(squares / static_cast<double>(surface.size())),
                       static_cast<int>(surface.size())};
}

bool Holds(const std::vector<SphereTarget3>& spheres, const Vector3d& p, double radius) {
  return std::any_of(spheres.begin(), spheres.end(),
                     [&](const SphereTarget3& sphere) { return (sphere.centre - p).norm() < 1.5 * radius; });
}

}  // namespace

std::vector<SphereTarget3> FindSpheres(std::span<const Eigen::Vector3f> cloud, const SphereSearchOptions& options) {
  const std::map<Box, std::vector<Vector3d>> boxes = IntoBoxes(cloud, options.radius_m);
  std::vector<SphereTarget3> spheres;
  std::uint32_t stream = 0;
  for (const auto& [box, points] : boxes) {
    ++stream;
    const std::size_t n = points.size();
    if (static_cast<int>(n) < options.min_points / 3 || Holds(spheres, points.front(), options.radius_m)) continue;
    const RandomStream random(StreamOfName("spheres"), 0, stream);
    for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
      const std::array<std::uint32_t, 4> bits = random.Bits(sample);
      const std::optional<Vector3d> centre =
          CentreThrough({points[bits[0] % n], points[bits[1] % n], points[bits[2] % n], points[bits[3] % n]}, options);
      if (!centre) continue;
      const std::optional<SphereTarget3> sphere = Measure(boxes, *centre, options);
      if (!sphere || Holds(spheres, sphere->centre, options.radius_m)) continue;
      spheres.push_back(*sphere);
      break;
    }
  }
  std::stable_sort(spheres.begin(), spheres.end(),
                   [](const SphereTarget3& a, const SphereTarget3& b) { return a.num_points > b.num_points; });
  return spheres;
}

}  // namespace survey
