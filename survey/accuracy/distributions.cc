// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/distributions.h"

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace survey {
namespace {

using DoubleOnly = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using ChiSquare = boost::math::chi_squared_distribution<double, DoubleOnly>;
using Fisher = boost::math::fisher_f_distribution<double, DoubleOnly>;
using NonCentralFisher = boost::math::non_central_f_distribution<double, DoubleOnly>;
using Normal = boost::math::normal_distribution<double, DoubleOnly>;
using Beta = boost::math::beta_distribution<double, DoubleOnly>;

}  // namespace

double NormalCdf(double z) { return 0.5 * std::erfc(-z * std::sqrt(0.5)); }

double NormalQuantile(double probability) { return quantile(Normal(), probability); }

double ChiSquareQuantile(double probability, double degrees_of_freedom) {
  return quantile(ChiSquare(degrees_of_freedom), probability);
}

double ChiSquareUpperTail(double value, double degrees_of_freedom) {
  return cdf(complement(ChiSquare(degrees_of_freedom), value));
}

double FisherUpperTail(double value, double numerator_dof, double denominator_dof) {
  return cdf(complement(Fisher(numerator_dof, denominator_dof), value));
}

double FisherQuantile(double probability, double numerator_dof, double denominator_dof) {
  return quantile(Fisher(numerator_dof, denominator_dof), probability);
}

double NonCentralFisherUpperTail(double value, double numerator_dof, double denominator_dof, double non_centrality) {
  if (non_centrality == 0.0) return FisherUpperTail(value, numerator_dof, denominator_dof);  // Boost 1.74 has 1 there
  return cdf(complement(NonCentralFisher(numerator_dof, denominator_dof, non_centrality), value));
}

double BetaQuantile(double probability, double alpha, double beta) { return quantile(Beta(alpha, beta), probability); }

double LargestRate(int hits, int trials, double confidence) {
  if (hits == trials) return 1.0;
  return BetaQuantile(confidence, hits + 1.0, static_cast<double>(trials - hits));
}

}  // namespace survey
