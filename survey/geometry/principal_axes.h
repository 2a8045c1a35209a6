// SPDX-License-Identifier: Apache-2.0
//
// Eigenvalues and eigenvectors of a symmetric 2 x 2 matrix in closed form, as of a covariance (m2) for its error
// ellipse.
#pragma once

#include <Eigen/Core>

namespace survey {

struct PrincipalAxes {
  Eigen::Vector2d values;  // ascending
  Eigen::Matrix2d axes;    // unit vectors, column k belongs to values[k]; right-handed
};

PrincipalAxes PrincipalAxesOf(const Eigen::Matrix2d& symmetric);

}  // namespace survey
