// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/surface_match.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr double kMaxStep_m = 0.3;
constexpr double kMaxStep_rad = 0.1;

// Normal equations of the distances at one pose.
struct Normals {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double square_m2 = 0.0;  // weighted mean square of the distances across surfaces
  int inliers = 0;
};

class Accumulator {
 public:
  // One distance r with direction n at arm (rx, ry) from the lidar, weight w.
  void Add(float nx, float ny, float rx, float ry, float r, float w) {
    const float jt = rx * ny - ry * nx;
    const Eigen::Array4f row(nx, ny, jt, r);
    x_ += w * nx * row;
    y_ += w * ny * row;
    t_ += w * jt * row;
  }
  void Finish(double scale, Normals* result) const {
    Eigen::Matrix<double, 3, 4> sums;
    sums << x_.matrix().transpose().cast<double>(), y_.matrix().transpose().cast<double>(),
        t_.matrix().transpose().cast<double>();
    result->normal = scale * sums.leftCols<3>().selfadjointView<Eigen::Upper>().toDenseMatrix();
    result->gradient = scale * sums.col(3);
  }

 private:
  // Weighted products of n_x, n_y and the turning arm with these three and r.
  Eigen::Array4f x_ = Eigen::Array4f::Zero();
  Eigen::Array4f y_ = Eigen::Array4f::Zero();
  Eigen::Array4f t_ = Eigen::Array4f::Zero();
};

Normals Evaluate(const SurfaceMap& map, std::span<const SurfacePoint> points, std::size_t stride, const Pose2& pose,
                 double loss_m, const SurfaceMatchOptions& options) {
  const auto c = static_cast<float>(std::cos(pose.theta));
  const auto s = static_cast<float>(std::sin(pose.theta));
  const auto tx = static_cast<float>(pose.x);
  const auto ty = static_cast<float>(pose.y);
  const auto inverse_loss_square = static_cast<float>(1.0 / (loss_m * loss_m));
  const auto point_weight = static_cast<float>(options.point_weight);
  const auto inlier_square = static_cast<float>(options.inlier_m * options.inlier_m);
  Accumulator sums;
  double squares = 0.0;
  double weights = 0.0;
  Normals result;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector2f& p = points[i].position;
    const Eigen::Vector2f& n = points[i].normal;
    const float rx = c * p.x() - s * p.y();
    const float ry = s * p.x() + c * p.y();
    const Eigen::Vector2f in_map(rx + tx, ry + ty);
    const Eigen::Vector2f normal(c * n.x() - s * n.y(), s * n.x() + c * n.y());
    const Surfel* surfel = map.Nearest(in_map, normal);
    if (surfel == nullptr) continue;
    const Eigen::Vector2f d = in_map - surfel->mean;
    const bool surface = surfel->normal.squaredNorm() > 0.5F;
    if (surface || n.squaredNorm() > 0.5F) {
      const Eigen::Vector2f& direction = surface ? surfel->normal : normal;
      const float r = direction.dot(d);
      const float w = 1.0F / (1.0F + r * r * inverse_loss_square);
      sums.Add(direction.x(), direction.y(), rx, ry, r, w);
      squares += static_cast<double>(w * r * r);
      weights += static_cast<double>(w);
      if (r * r < inlier_square) ++result.inliers;
    } else {
      const float square = d.squaredNorm();
      const float w = points[i].weight * point_weight / (1.0F + square * inverse_loss_square);
      sums.Add(1.0F, 0.0F, rx, ry, d.x(), w);
      sums.Add(0.0F, 1.0F, rx, ry, d.y(), w);
      if (square < inlier_square) ++result.inliers;
    }
  }
  if (weights > 0.0) result.square_m2 = squares / weights;
  const double variance = std::max(result.square_m2, options.min_sigma_m * options.min_sigma_m);
  sums.Finish(static_cast<double>(stride) * options.independent_share / variance, &result);
  return result;
}

// The poses that a search tries: `shifts` steps to either side along x and y, `turns` to the left and right.
struct SearchSteps {
  double step_m;
  double step_rad;
  int shifts;
  int turns;

  double Count() const { return std::pow(2.0 * shifts + 1.0, 2) * (2.0 * turns + 1.0); }
};

// By the map's cells; twice as far where that would be too many poses, which is still within what SurfaceMap::Near
// tells.
SearchSteps StepsOf(double cell_size_m, double mean_range_m, double half_width_m, double half_angle_rad) {
  constexpr double kMostPoses = 50'000;
  const auto of = [&](double step_m) {
    const double step_rad = step_m / mean_range_m;
    return SearchSteps{step_m, step_rad, static_cast<int>(std::ceil(half_width_m / step_m)),
                       static_cast<int>(std::ceil(half_angle_rad / step_rad))};
  };
  const SearchSteps steps = of(cell_size_m);
  return steps.Count() > kMostPoses ? of(2.0 * cell_size_m) : steps;
}

}  // namespace

MatchResult MatchToSurfaces(const SurfaceMap* coarse, const SurfaceMap& map,
                            std::span<const SurfacePoint> points_in_scan, const Pose2& start, const Pose2& predicted,
                            const Eigen::Matrix3d& prediction_covariance, const SurfaceMatchOptions& options) {
  MatchResult result{.map_from_scan = start};
  if (points_in_scan.empty()) return result;
  const Eigen::Matrix3d prediction_information = prediction_covariance.inverse();
  const auto offset = [&](const Pose2& pose) {
    return Eigen::Vector3d(pose.x - predicted.x, pose.y - predicted.y, NormalizeAngle(pose.theta - predicted.theta));
  };
  Pose2 pose = start;
  Normals current;
  Eigen::Matrix3d normal = prediction_information;
  const auto step = [&](const SurfaceMap& surfaces, std::size_t stride, double loss_m) {
    current = Evaluate(surfaces, points_in_scan, stride, pose, loss_m, options);
    normal = current.normal + prediction_information;
    const Eigen::Vector3d full = -normal.ldlt().solve(current.gradient + prediction_information * offset(pose));
    // A step beyond the reach of the cells around says nothing: go a part of the way and look again.
    const double part = std::min({1.0, kMaxStep_m / full.head<2>().norm(), kMaxStep_rad / std::abs(full.z())});
    const Eigen::Vector3d d = part * full;
    pose = {pose.x + d.x(), pose.y + d.y(), NormalizeAngle(pose.theta + d.z())};
    return d;
  };
  const auto small = [](const Eigen::Vector3d& d, double step_m, double step_rad) {
    return d.head<2>().norm() < step_m && std::abs(d.z()) < step_rad;
  };
  constexpr std::size_t kCoarseStride = 4;
  for (int i = 0; coarse != nullptr && i < 4; ++i) {
    if (small(step(*coarse, kCoarseStride, options.coarse_loss_m), 0.02, 0.002)) break;
  }
  // Until what is left to go, if steps go on shrinking as the last two did (a geometric series), is small.
  double last_size = 0.0;
  for (int i = 0; i < options.max_iterations; ++i) {
    const Eigen::Vector3d d = step(map, 1, options.loss_m);
    const double size = std::max(d.head<2>().norm() / options.step_m, std::abs(d.z()) / options.step_rad);
    if (size < 1.0 || size * size < last_size - size) break;
    last_size = size;
  }
  if (!pose.Vector().allFinite()) return result;
  result.map_from_scan = pose;
  result.information = current.normal;
  result.score = static_cast<double>(current.inliers) / static_cast<double>(points_in_scan.size());
  result.covariance = normal.inverse();
  result.usable = result.covariance.allFinite();
  return result;
}

std::vector<Pose2> SearchSurfaces(const SurfaceMap& map, std::span<const SurfacePoint> points_in_scan,
                                  const Pose2& centre, double half_width_m, double half_angle_rad) {
  if (points_in_scan.empty()) return {};
  constexpr std::size_t kMaxPoints = 80;
  constexpr std::size_t kMaxModes = 4;
  const std::size_t stride = (points_in_scan.size() + kMaxPoints - 1) / kMaxPoints;
  double mean_range = 0.0;
  for (const SurfacePoint& p : points_in_scan) mean_range += static_cast<double>(p.position.norm());
  mean_range = std::max(mean_range / static_cast<double>(points_in_scan.size()), 1.0);
  const SearchSteps steps = StepsOf(map.cell_size_m(), mean_range, half_width_m, half_angle_rad);

  struct Scored {
    int turn, dx, dy, score;
  };
  std::vector<Scored> scored;
  std::vector<Eigen::Vector2f> turned;
  for (int turn = -steps.turns; turn <= steps.turns; ++turn) {
    const Eigen::Matrix2f rotation = Rotation2(centre.theta + turn * steps.step_rad).cast<float>();
    turned.clear();
    for (std::size_t i = 0; i < points_in_scan.size(); i += stride)
      turned.push_back(rotation * points_in_scan[i].position + centre.Translation().cast<float>());
    for (int dx = -steps.shifts; dx <= steps.shifts; ++dx) {
      for (int dy = -steps.shifts; dy <= steps.shifts; ++dy) {
        const Eigen::Vector2f shift(static_cast<float>(dx * steps.step_m), static_cast<float>(dy * steps.step_m));
        int score = 0;
        for (const Eigen::Vector2f& p : turned) score += map.Near(p.x() + shift.x(), p.y() + shift.y()) ? 1 : 0;
        scored.push_back({turn, dx, dy, score});
      }
    }
  }
  std::stable_sort(scored.begin(), scored.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<Scored> modes;
  for (const Scored& candidate : scored) {
    const bool close = std::any_of(modes.begin(), modes.end(), [&](const Scored& mode) {
      return std::abs(mode.dx - candidate.dx) < 3 && std::abs(mode.dy - candidate.dy) < 3 &&
             std::abs(mode.turn - candidate.turn) < 3;
    });
    if (close) continue;
    modes.push_back(candidate);
    if (modes.size() == kMaxModes) break;
  }
  std::vector<Pose2> poses;
  for (const Scored& mode : modes) {
    poses.push_back({centre.x + mode.dx * steps.step_m, centre.y + mode.dy * steps.step_m,
                     NormalizeAngle(centre.theta + mode.turn * steps.step_rad)});
  }
  return poses;
}

}  // namespace survey
