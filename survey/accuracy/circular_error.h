// SPDX-License-Identifier: Apache-2.0
//
// Circular errors of a bivariate normal error with any mean and covariance, by quadrature. The usual factor 1.7308 (or
// 2.4477) holds for equal axes only: along a corridor it is up to 25 % wrong.
#pragma once

#include <Eigen/Core>

namespace survey {

// P(|N(mean, covariance)| <= radius). The covariance may be singular.
double ProbabilityWithin(double radius, const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance);

// The smallest radius that holds the error with the given probability (0 < probability < 1), to 1e-7 of itself.
double CircularError(double probability, const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance);

}  // namespace survey
