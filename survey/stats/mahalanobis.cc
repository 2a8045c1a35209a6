// SPDX-License-Identifier: Apache-2.0
#include "survey/stats/mahalanobis.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace survey {

double SquaredMahalanobis(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance) {
  return error.dot(covariance.inverse() * error);
}

double SquaredMahalanobis(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

}  // namespace survey
