// SPDX-License-Identifier: Apache-2.0
//
// How far an error lies from zero in units of its covariance, squared (P. C. Mahalanobis, 1936): e' C^-1 e, distributed
// as chi-square with as many degrees of freedom as the error has components, if the covariance holds.
#pragma once

#include <Eigen/Core>

namespace survey {

double SquaredMahalanobis(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance);
double SquaredMahalanobis(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);

}  // namespace survey
