// SPDX-License-Identifier: Apache-2.0
#include "survey/control/site_tie.h"

#include <cmath>

namespace survey {
namespace {

struct Sums {
  double dot = 0.0, cross = 0.0, grid_squares = 0.0, projected_squares = 0.0;
  double mirrored_dot = 0.0, mirrored_cross = 0.0;  // with the grid's axes exchanged
};

Sums SumsOf(const std::vector<TiePoint>& points, const Eigen::Vector2d& grid_centre, const Eigen::Vector2d& centre) {
  Sums sums;
  for (const TiePoint& point : points) {
    const Eigen::Vector2d g = point.in_grid - grid_centre, p = point.in_projected - centre;
    sums.dot += g.dot(p);
    sums.cross += g.x() * p.y() - g.y() * p.x();
    sums.mirrored_dot += g.y() * p.x() + g.x() * p.y();
    sums.mirrored_cross += g.y() * p.y() - g.x() * p.x();
    sums.grid_squares += g.squaredNorm();
    sums.projected_squares += p.squaredNorm();
  }
  return sums;
}

}  // namespace

Eigen::Vector2d SiteTie::Apply(const Eigen::Vector2d& in_grid) const {
  const double c = scale * std::cos(rotation), s = scale * std::sin(rotation);
  const Eigen::Vector2d d = in_grid - grid_origin;
  return origin + Eigen::Vector2d(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

Eigen::Matrix2d SiteTie::Apply(const Eigen::Matrix2d& covariance_in_grid) const {
  const double c = scale * std::cos(rotation), s = scale * std::sin(rotation);
  const Eigen::Matrix2d turn = (Eigen::Matrix2d() << c, -s, s, c).finished();
  return turn * covariance_in_grid * turn.transpose();
}

SiteTie FitSiteTie(const std::vector<TiePoint>& points, bool with_scale) {
  SiteTie tie;
  if (points.size() < 2) {
    tie.message = "two points at least must be known in both systems, found " + std::to_string(points.size());
    return tie;
  }
  for (const TiePoint& point : points) {
    tie.grid_origin += point.in_grid / static_cast<double>(points.size());
    tie.origin += point.in_projected / static_cast<double>(points.size());
  }
  const Sums sums = SumsOf(points, tie.grid_origin, tie.origin);
  const double fit = std::hypot(sums.dot, sums.cross);
  if (sums.grid_squares == 0.0 || sums.projected_squares == 0.0) {
    tie.message = "all points are the same place";
    return tie;
  }
  // What is left of the projected square sum after the best similarity; the mirror image must not do better.
  const double left = sums.projected_squares - fit * fit / sums.grid_squares;
  const double mirrored = std::hypot(sums.mirrored_dot, sums.mirrored_cross);
  const double left_mirrored = sums.projected_squares - mirrored * mirrored / sums.grid_squares;
  if (points.size() > 2 && left_mirrored < 0.01 * left) {
    tie.message = "the axes of one system are exchanged: the points fit only as a mirror image";
    return tie;
  }
  tie.rotation = std::atan2(sums.cross, sums.dot);
  tie.fitted_scale = fit / sums.grid_squares;
  tie.num_parameters = with_scale ? 4 : 3;
  tie.scale = with_scale ? tie.fitted_scale : 1.0;
  double squares = 0.0;
  for (const TiePoint& point : points) {
    tie.residuals.push_back(tie.Apply(point.in_grid) - point.in_projected);
    squares += tie.residuals.back().squaredNorm();
  }
  tie.degrees_of_freedom = 2 * static_cast<int>(points.size()) - tie.num_parameters;
  if (tie.degrees_of_freedom > 0) tie.sigma_zero = std::sqrt(squares / tie.degrees_of_freedom);
  tie.usable = true;
  return tie;
}

}  // namespace survey
