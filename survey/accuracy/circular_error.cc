// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/circular_error.h"

#include <algorithm>
#include <cmath>

#include "survey/accuracy/distributions.h"
#include "survey/geometry/principal_axes.h"

namespace survey {
namespace {

// Eight-point Gauss-Legendre rule on [-1, 1], positive half.
constexpr double kNodes[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr double kWeights[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
constexpr int kPanels = 24;
constexpr double kTails = 9.0;  // sigmas beyond which a normal density counts as zero

// The error in its principal axes, u along the larger sigma.
struct PrincipalError {
  double mean_u = 0.0, mean_v = 0.0, sigma_u = 0.0, sigma_v = 0.0;
};

PrincipalError ToPrincipalAxes(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
  const PrincipalAxes principal = PrincipalAxesOf(covariance);
  const Eigen::Vector2d turned = principal.axes.transpose() * mean;
  const Eigen::Vector2d sigmas = principal.values.cwiseMax(0.0).cwiseSqrt();
  return {turned.y(), turned.x(), sigmas.y(), sigmas.x()};
}

double ProbabilityBetween(double low, double high, double mean, double sigma) {
  if (sigma <= 0.0) return low <= mean && mean <= high ? 1.0 : 0.0;
  return NormalCdf((high - mean) / sigma) - NormalCdf((low - mean) / sigma);
}

// Integral over u = radius sin(a) of density(u) P(|v| <= radius cos(a)).
double ProbabilityWithin(double radius, const PrincipalError& error) {
  if (radius <= 0.0) return 0.0;
  if (error.sigma_u <= 0.0) return std::hypot(error.mean_u, error.mean_v) <= radius ? 1.0 : 0.0;
  const auto angle_of = [radius](double u) { return std::asin(std::clamp(u / radius, -1.0, 1.0)); };
  const double begin = angle_of(error.mean_u - kTails * error.sigma_u);
  const double step = (angle_of(error.mean_u + kTails * error.sigma_u) - begin) / kPanels;
  const auto integrand = [&](double angle) {
    const double half_chord = radius * std::cos(angle);
    const double z = (radius * std::sin(angle) - error.mean_u) / error.sigma_u;
    return std::exp(-0.5 * z * z) * half_chord *
           ProbabilityBetween(-half_chord, half_chord, error.mean_v, error.sigma_v);
  };
  double sum = 0.0;
  for (int panel = 0; panel < kPanels; ++panel) {
    const double middle = begin + (panel + 0.5) * step;
    for (int i = 0; i < 4; ++i) {
      sum += kWeights[i] * (integrand(middle - 0.5 * step * kNodes[i]) + integrand(middle + 0.5 * step * kNodes[i]));
    }
  }
  return sum * 0.5 * step / (error.sigma_u * std::sqrt(2.0 * M_PI));
}

}  // namespace

double ProbabilityWithin(double radius, const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
  return ProbabilityWithin(radius, ToPrincipalAxes(mean, covariance));
}

double CircularError(double probability, const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
  const PrincipalError error = ToPrincipalAxes(mean, covariance);
  double low = 0.0;
  double high = std::hypot(error.mean_u, error.mean_v) + kTails * std::hypot(error.sigma_u, error.sigma_v);
  while (high - low > 1e-7 * high) {
    const double middle = 0.5 * (low + high);
    (ProbabilityWithin(middle, error) < probability ? low : high) = middle;
  }
  return high;
}

}  // namespace survey
