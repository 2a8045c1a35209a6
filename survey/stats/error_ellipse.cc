// SPDX-License-Identifier: Apache-2.0
#include "survey/stats/error_ellipse.h"

#include <algorithm>
#include <cmath>

#include "survey/geometry/principal_axes.h"

namespace survey {

ErrorEllipse EllipseOf(const Eigen::Matrix2d& covariance) {
  const PrincipalAxes principal = PrincipalAxesOf(covariance);
  const Eigen::Vector2d major = principal.axes.col(1);
  double azimuth = std::atan2(major.x(), major.y());
  if (azimuth < 0.0) azimuth += M_PI;
  if (azimuth >= M_PI) azimuth -= M_PI;
  return {.semi_major = std::sqrt(std::max(0.0, principal.values[1])),
          .semi_minor = std::sqrt(std::max(0.0, principal.values[0])),
          .azimuth = azimuth};
}

}  // namespace survey
