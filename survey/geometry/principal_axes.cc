// SPDX-License-Identifier: Apache-2.0
#include "survey/geometry/principal_axes.h"

#include <cmath>

namespace survey {

PrincipalAxes PrincipalAxesOf(const Eigen::Matrix2d& symmetric) {
  const double mean = 0.5 * (symmetric(0, 0) + symmetric(1, 1));
  const double half_difference = 0.5 * (symmetric(0, 0) - symmetric(1, 1));
  const double radius = std::hypot(half_difference, symmetric(0, 1));
  const double angle = 0.5 * std::atan2(symmetric(0, 1), half_difference);  // of the larger
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {.values = {mean - radius, mean + radius}, .axes = (Eigen::Matrix2d() << s, c, -c, s).finished()};
}

}  // namespace survey
