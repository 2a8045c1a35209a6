// SPDX-License-Identifier: Apache-2.0
#include "survey/control/coordinate_reduction.h"

#include <cmath>
#include <cstdio>

namespace survey {
namespace {

template <typename... Arguments>
std::string Text(const char* format, Arguments... arguments) {
  char text[400];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}

// Points known by name only have no covariance and no place.
bool HasPlace(const ControlPoint& point) { return !point.covariance.isZero(0.0); }

void ApplyLinear(const Eigen::Matrix2d& turn, ControlNetwork* network) {
  for (ControlPoint& point : network->points) point.covariance = turn * point.covariance * turn.transpose();
  for (PointCorrelation& pair : network->correlations) pair.covariance = turn * pair.covariance * turn.transpose();
}

}  // namespace

void ApplySiteTie(const SiteTie& tie, const std::vector<TiePoint>& points, ControlNetwork* network) {
  for (ControlPoint& point : network->points) {
    if (HasPlace(point)) point.position_in_site = tie.Apply(point.position_in_site);
  }
  const double c = tie.scale * std::cos(tie.rotation), s = tie.scale * std::sin(tie.rotation);
  ApplyLinear((Eigen::Matrix2d() << c, -s, s, c).finished(), network);
  network->remarks.push_back(Text(
      "coordinates are transformed from the site grid by %d parameters on %d points: rotation %.4f gon, scale %.8f%s, "
      "sigma zero %.1f mm with %d degrees of freedom",
      tie.num_parameters, static_cast<int>(points.size()), tie.rotation * 200.0 / M_PI, tie.scale,
      tie.num_parameters == 3 ? Text(" (not applied: %.8f)", tie.fitted_scale).c_str() : "", 1000.0 * tie.sigma_zero,
      tie.degrees_of_freedom));
  for (std::size_t i = 0; i < points.size(); ++i) {
    network->remarks.push_back(Text("tie point %s: residual east %.1f mm, north %.1f mm", points[i].name.c_str(),
                                    1000.0 * tie.residuals[i].x(), 1000.0 * tie.residuals[i].y()));
  }
}

void ReduceToGrid(double combined_factor, const Eigen::Vector2d& origin, ControlNetwork* network) {
  for (ControlPoint& point : network->points) {
    if (HasPlace(point)) point.position_in_site = origin + combined_factor * (point.position_in_site - origin);
  }
  ApplyLinear(Eigen::Matrix2d::Identity() * combined_factor, network);
  network->remarks.push_back(Text(
      "control is given in ground coordinates; they are reduced to the grid with the combined factor %.8f about east "
      "%.3f, north %.3f",
      combined_factor, origin.x(), origin.y()));
}

}  // namespace survey
