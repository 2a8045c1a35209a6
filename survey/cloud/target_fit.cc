// SPDX-License-Identifier: Apache-2.0
#include "survey/cloud/target_fit.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "survey/accuracy/distributions.h"

namespace survey {
namespace {

using Eigen::Vector3d;

constexpr double kLargestScaleError = 1e-4;

struct Match {
  int sphere = 0;
  int target = 0;
};

struct Points {
  Eigen::Matrix3Xd cloud, site;
};

Points PointsOf(const std::vector<Match>& matches, std::span<const Vector3d> spheres,
                std::span<const KnownTarget> targets) {
  const auto n = static_cast<Eigen::Index>(matches.size());
  Points points{Eigen::Matrix3Xd(3, n), Eigen::Matrix3Xd(3, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Match& match = matches[static_cast<std::size_t>(i)];
    points.cloud.col(i) = spheres[static_cast<std::size_t>(match.sphere)];
    points.site.col(i) = targets[static_cast<std::size_t>(match.target)].position_in_site;
  }
  return points;
}

Eigen::Isometry3d Rigid(const Points& points) {
  Eigen::Isometry3d transform;
  transform.matrix() = Eigen::umeyama(points.cloud, points.site, false);
  return transform;
}

double RmsOf(const Points& points, const Eigen::Isometry3d& site_from_cloud) {
  const Eigen::Matrix3Xd residuals = (site_from_cloud * points.cloud) - points.site;
  return std::sqrt(residuals.squaredNorm() / static_cast<double>(points.cloud.cols()));
}

// All pairs of a sphere and a target that lie where `site_from_cloud` puts them; each once.
std::vector<Match> Supporters(const Eigen::Isometry3d& site_from_cloud, std::span<const Vector3d> spheres,
                              std::span<const KnownTarget> targets, double tolerance) {
  std::vector<Match> matches;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    int nearest = -1;
    double distance = tolerance;
    for (std::size_t s = 0; s < spheres.size(); ++s) {
      const double d = (site_from_cloud * spheres[s] - targets[t].position_in_site).norm();
      if (d <= distance) {
        distance = d;
        nearest = static_cast<int>(s);
      }
    }
    if (nearest >= 0) matches.push_back({nearest, static_cast<int>(t)});
  }
  return matches;
}

double Span(const std::vector<Match>& matches, std::span<const KnownTarget> targets) {
  double span = 0.0;
  for (const Match& a : matches) {
    for (const Match& b : matches) {
      span = std::max(span, (targets[static_cast<std::size_t>(a.target)].position_in_site -
                             targets[static_cast<std::size_t>(b.target)].position_in_site)
                                .norm());
    }
  }
  return span;
}

// The most matches that any three congruent pairs lead to.
std::vector<Match> BestMatches(std::span<const Vector3d> spheres, std::span<const KnownTarget> targets,
                               double tolerance) {
  std::vector<Match> best;
  const int num_spheres = static_cast<int>(spheres.size()), num_targets = static_cast<int>(targets.size());
  const auto fits = [&](const Match& a, const Match& b) {
    const double measured =
        (spheres[static_cast<std::size_t>(a.sphere)] - spheres[static_cast<std::size_t>(b.sphere)]).norm();
    const double known = (targets[static_cast<std::size_t>(a.target)].position_in_site -
                          targets[static_cast<std::size_t>(b.target)].position_in_site)
                             .norm();
    return known > 1.0 && std::abs(measured - known) <= tolerance;
  };
  const auto try_three = [&](const std::vector<Match>& three) {
    const Eigen::Isometry3d first = Rigid(PointsOf(three, spheres, targets));
    std::vector<Match> matches = Supporters(first, spheres, targets, 3.0 * tolerance);
    if (matches.size() < 3) return;
    matches = Supporters(Rigid(PointsOf(matches, spheres, targets)), spheres, targets, tolerance);
    const bool better =
        matches.size() > best.size() || (matches.size() == best.size() && Span(matches, targets) > Span(best, targets));
    if (matches.size() >= 3 && better) best = matches;
  };
  for (int t0 = 0; t0 < num_targets; ++t0) {
    for (int s0 = 0; s0 < num_spheres; ++s0) {
      for (int t1 = t0 + 1; t1 < num_targets; ++t1) {
        for (int s1 = 0; s1 < num_spheres; ++s1) {
          if (s1 == s0 || !fits({s0, t0}, {s1, t1})) continue;
          for (int t2 = t1 + 1; t2 < num_targets; ++t2) {
            for (int s2 = 0; s2 < num_spheres; ++s2) {
              if (s2 == s0 || s2 == s1 || !fits({s0, t0}, {s2, t2}) || !fits({s1, t1}, {s2, t2})) continue;
              try_three({{s0, t0}, {s1, t1}, {s2, t2}});
            }
          }
        }
      }
      if (best.size() == targets.size()) return best;
    }
  }
  return best;
}

void TestScale(const Points& points, TargetFit* fit) {
  const Eigen::Matrix4d similarity = Eigen::umeyama(points.cloud, points.site, true);
  fit->scale = similarity.topLeftCorner<3, 1>().norm();
  const Eigen::Matrix3Xd centred = points.cloud.colwise() - points.cloud.rowwise().mean();
  const double dof = 3.0 * static_cast<double>(points.cloud.cols()) - 7.0;
  const Eigen::Matrix3Xd residuals =
      (similarity.topLeftCorner<3, 3>() * points.cloud).colwise() + Vector3d(similarity.topRightCorner<3, 1>());
  const double sigma = std::sqrt((residuals - points.site).squaredNorm() / dof);
  fit->scale_sigma = sigma / centred.norm();
}

void EstimateSigma(const Points& points, double listed_variance, TargetFit* fit) {
  const double degrees_of_freedom = 3.0 * static_cast<double>(points.site.cols()) - 6.0;
  const double squares = fit->rms_m * fit->rms_m * static_cast<double>(points.site.cols());
  const bool contradicted = squares / listed_variance > ChiSquareQuantile(0.95, degrees_of_freedom);
  fit->sigma_m = std::sqrt(contradicted ? squares / degrees_of_freedom : listed_variance);
  const Eigen::Matrix2Xd plan = points.site.topRows<2>();
  fit->middle_in_site = plan.rowwise().mean();
  fit->plan_moment = (plan.colwise() - fit->middle_in_site).squaredNorm();
}

void FitMatches(const std::vector<Match>& matches, std::span<const Vector3d> spheres,
                std::span<const KnownTarget> targets, TargetFit* fit) {
  const Points points = PointsOf(matches, spheres, targets);
  fit->site_from_cloud = Rigid(points);
  fit->rms_m = RmsOf(points, fit->site_from_cloud);
  double listed_variance = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const KnownTarget& target = targets[static_cast<std::size_t>(matches[i].target)];
    listed_variance += target.sigma_m * target.sigma_m / static_cast<double>(matches.size());
    const auto column = static_cast<Eigen::Index>(i);
    fit->residuals.push_back({target.name, matches[i].sphere,
                              fit->site_from_cloud * Vector3d(points.cloud.col(column)) - points.site.col(column)});
  }
  EstimateSigma(points, listed_variance, fit);
  TestScale(points, fit);
}

std::vector<Vector3d> Mirrored(std::span<const Vector3d> spheres) {
  std::vector<Vector3d> mirrored;
  for (const Vector3d& p : spheres) mirrored.emplace_back(p.x(), p.y(), -p.z());
  return mirrored;
}

std::vector<Vector3d> Scaled(std::span<const Vector3d> spheres, double factor) {
  std::vector<Vector3d> scaled;
  for (const Vector3d& p : spheres) scaled.emplace_back(factor * p);
  return scaled;
}

// Why no three targets were found again: other units, or nothing that fits.
std::string Reason(std::span<const Vector3d> spheres, std::span<const KnownTarget> targets, double tolerance) {
  for (const auto& [factor, name] : {std::pair{0.001, "millimetres"}, {0.3048, "feet"}, {0.01, "centimetres"}}) {
    if (BestMatches(Scaled(spheres, factor), targets, tolerance).size() >= 3) {
      return std::string("the cloud seems to be in ") + name + ", not metres";
    }
  }
  return "fewer than three targets were found again by their distances (" + std::to_string(spheres.size()) +
         " in the cloud, " + std::to_string(targets.size()) + " targets listed)";
}

}  // namespace

Eigen::Matrix2d TargetFit::CovarianceAt(const Eigen::Vector2d& p_in_site) const {
  const Eigen::Vector2d lever = p_in_site - middle_in_site;
  const Eigen::Vector2d by_turn(-lever.y(), lever.x());
  const double of_shift = 1.0 / static_cast<double>(residuals.size());
  return sigma_m * sigma_m * (of_shift * Eigen::Matrix2d::Identity() + by_turn * by_turn.transpose() / plan_moment);
}

TargetFit FitTargets(std::span<const Vector3d> spheres, std::span<const KnownTarget> targets,
                     const TargetFitOptions& options) {
  TargetFit fit;
  if (targets.size() < 3) {
    fit.message = "needs three targets at least, " + std::to_string(targets.size()) + " listed";
    return fit;
  }
  const std::vector<Match> matches = BestMatches(spheres, targets, options.tolerance_m);
  const std::vector<Match> mirrored = BestMatches(Mirrored(spheres), targets, options.tolerance_m);
  // Three lie in a plane and fit their mirror image as well.
  if (mirrored.size() > std::max<std::size_t>(matches.size(), 3)) {
    fit.message = "the mirror image of the cloud fits: an axis points the other way, or two are exchanged";
    return fit;
  }
  if (matches.size() < 3) {
    fit.message = Reason(spheres, targets, options.tolerance_m);
    return fit;
  }
  FitMatches(matches, spheres, targets, &fit);
  fit.usable = std::abs(fit.scale - 1.0) <= std::max(3.0 * fit.scale_sigma, kLargestScaleError);
  if (!fit.usable) fit.message = "the scale of the cloud differs from the targets' beyond its uncertainty";
  return fit;
}

}  // namespace survey
