// SPDX-License-Identifier: Apache-2.0
#include "survey/stats/reliability.h"

#include <Eigen/LU>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <cmath>
#include <limits>

#include "survey/geometry/principal_axes.h"

namespace survey {
namespace {

using DoubleOnly = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using ChiSquare = boost::math::chi_squared_distribution<double, DoubleOnly>;
using NonCentralChiSquare = boost::math::non_central_chi_squared_distribution<double, DoubleOnly>;

constexpr double kUncontrolled = 1e-9;  // redundancy below which an observation is not controlled at all

}  // namespace

double CriticalT(double significance, int degrees_of_freedom) {
  return quantile(complement(ChiSquare(degrees_of_freedom), significance));
}

double CriticalW(double significance) { return std::sqrt(CriticalT(significance, 1)); }

double NonCentrality(const TestLevel& level, int degrees_of_freedom) {
  const double critical = CriticalT(level.significance, degrees_of_freedom);
  return NonCentralChiSquare::find_non_centrality(degrees_of_freedom, critical, 1.0 - level.power);
}

double MinimalDetectableBias(double p_qvv_p, double non_centrality) {
  if (p_qvv_p <= 0.0) return std::numeric_limits<double>::infinity();
  return std::sqrt(non_centrality / p_qvv_p);
}

double MinimalDetectableBias(const Eigen::Matrix2d& covariance, const Eigen::Matrix2d& residual_covariance,
                             double non_centrality) {
  const Eigen::Matrix2d weight = covariance.inverse();
  const Eigen::Matrix2d controlled = weight * residual_covariance * weight;
  const double least = PrincipalAxesOf(controlled).values[0];
  if (least <= kUncontrolled * weight.trace()) return std::numeric_limits<double>::infinity();
  return std::sqrt(non_centrality / least);
}

}  // namespace survey
