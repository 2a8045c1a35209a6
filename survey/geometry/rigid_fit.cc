// SPDX-License-Identifier: Apache-2.0
#include "survey/geometry/rigid_fit.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace survey {
namespace {

std::vector<double> Residuals(const Pose2& target_from_source, std::span<const Eigen::Vector2d> source,
                              std::span<const Eigen::Vector2d> target) {
  std::vector<double> residuals;
  for (std::size_t i = 0; i < source.size(); ++i)
    residuals.push_back((target[i] - target_from_source * source[i]).norm());
  return residuals;
}

double UpperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<RigidFit> FitRigid(std::span<const Eigen::Vector2d> source, std::span<const Eigen::Vector2d> target,
                                 std::span<const double> weights) {
  const std::size_t n = source.size();
  if (n < 2 || target.size() != n || (!weights.empty() && weights.size() != n)) return std::nullopt;
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };

  double total = 0.0;
  Eigen::Vector2d source_centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_centre = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    total += weight(i);
    source_centre += weight(i) * source[i];
    target_centre += weight(i) * target[i];
  }
  if (!(total > 0.0)) return std::nullopt;
  source_centre /= total;
  target_centre /= total;

  double dot = 0.0;
  double cross = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d s = source[i] - source_centre;
    const Eigen::Vector2d t = target[i] - target_centre;
    dot += weight(i) * s.dot(t);
    cross += weight(i) * (s.x() * t.y() - s.y() * t.x());
    spread += weight(i) * s.squaredNorm();
  }
  const double length = std::hypot(dot, cross);
  if (!(spread > 1e-12 * total) || !(length > 1e-12 * total)) return std::nullopt;

  RigidFit fit;
  fit.target_from_source.theta = std::atan2(cross, dot);
  const Eigen::Vector2d translation = target_centre - Rotation2(fit.target_from_source.theta) * source_centre;
  fit.target_from_source.x = translation.x();
  fit.target_from_source.y = translation.y();
  fit.similarity_scale = length / spread;
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) squares += (target[i] - fit.target_from_source * source[i]).squaredNorm();
  fit.rms_m = std::sqrt(squares / static_cast<double>(n));
  return fit;
}

std::optional<RigidFit> FitRigidRobust(std::span<const Eigen::Vector2d> source,
                                       std::span<const Eigen::Vector2d> target) {
  const std::size_t n = source.size();
  if (n < 4) return FitRigid(source, target);
  double least = std::numeric_limits<double>::infinity();
  Pose2 best;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const auto fit = FitRigid(std::array{source[i], source[j]}, std::array{target[i], target[j]});
      if (!fit) continue;
      const double median = UpperMedian(Residuals(fit->target_from_source, source, target));
      if (median >= least) continue;
      least = median;
      best = fit->target_from_source;
    }
  }
  const std::vector<double> residuals = Residuals(best, source, target);
  std::vector<double> weights;
  for (const double residual : residuals) weights.push_back(residual <= 2.5 * 1.4826 * least ? 1.0 : 0.0);
  return FitRigid(source, target, weights);
}

bool FitsOnlyMirrored(std::span<const Eigen::Vector2d> source, std::span<const Eigen::Vector2d> target) {
  if (source.size() < 3) return false;
  std::vector<Eigen::Vector2d> mirrored;
  for (const Eigen::Vector2d& p : source) mirrored.emplace_back(p.x(), -p.y());
  const auto as_it_is = FitRigid(source, target);
  const auto as_image = FitRigid(mirrored, target);
  return as_it_is && as_image && as_image->rms_m < 0.1 * as_it_is->rms_m;
}

}  // namespace survey
