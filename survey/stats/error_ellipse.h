// SPDX-License-Identifier: Apache-2.0
//
// The standard error ellipse of a place in the plane.
#pragma once

#include <Eigen/Core>

namespace survey {

// Semi-axes of the ellipse that holds 95 % of a normal error, in those of the standard ellipse: sqrt(chi-square), two
// degrees of freedom.
inline constexpr double kEllipse95 = 2.4477;

struct ErrorEllipse {
  double semi_major = 0.0;  // m
  double semi_minor = 0.0;
  double azimuth = 0.0;  // of the major axis, rad clockwise from y (north), [0, pi)
};

// For covariance in the order x (east), y (north); one sigma.
ErrorEllipse EllipseOf(const Eigen::Matrix2d& covariance);

}  // namespace survey
