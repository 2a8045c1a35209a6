// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/normality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "survey/accuracy/distributions.h"
#include "survey/accuracy/moments.h"

namespace survey {
namespace {

constexpr std::size_t kFewestForPair = 8;
constexpr std::size_t kMostForShapiroWilk = 5000;

template <std::size_t N>
double Polynomial(const std::array<double, N>& coefficients, double x) {
  double value = 0.0;
  for (std::size_t i = N; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

// Weights of the differences between the i-th largest and the i-th smallest value; [Royston95] section 2.
std::vector<double> ShapiroWilkWeights(std::size_t n) {
  if (n == 3) return {std::sqrt(0.5)};
  const auto count = static_cast<double>(n);
  std::vector<double> scores(n / 2);
  double squares = 0.0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i] = -NormalQuantile((static_cast<double>(i) + 0.625) / (count + 0.25));
    squares += 2.0 * scores[i] * scores[i];
  }
  const double u = 1.0 / std::sqrt(count);
  constexpr std::array<double, 6> kLast = {0.0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
  constexpr std::array<double, 6> kNext = {0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
  std::vector<double> weights = {scores[0] / std::sqrt(squares) + Polynomial(kLast, u)};
  if (n > 5) weights.push_back(scores[1] / std::sqrt(squares) + Polynomial(kNext, u));
  double rest = squares, unit = 1.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    rest -= 2.0 * scores[i] * scores[i];
    unit -= 2.0 * weights[i] * weights[i];
  }
  for (std::size_t i = weights.size(); i < scores.size(); ++i) weights.push_back(scores[i] / std::sqrt(rest / unit));
  return weights;
}

// [Royston95] section 3: a function of 1 - W that is nearly normal.
double ShapiroWilkPValue(double w, std::size_t count) {
  const auto n = static_cast<double>(count);
  if (count == 3) return std::max(0.0, 6.0 / M_PI * (std::asin(std::sqrt(w)) - std::asin(std::sqrt(0.75))));
  const double y = std::log(1.0 - w);
  if (count <= 11) {
    const double gamma = -2.273 + 0.459 * n;
    if (y >= gamma) return 0.0;
    const double mean = Polynomial(std::array{0.544, -0.39978, 0.025054, -6.714e-4}, n);
    const double sigma = std::exp(Polynomial(std::array{1.3822, -0.77857, 0.062767, -0.0020322}, n));
    return NormalCdf(-(-std::log(gamma - y) - mean) / sigma);
  }
  const double log_n = std::log(n);
  const double mean = Polynomial(std::array{-1.5861, -0.31082, -0.083751, 0.0038915}, log_n);
  const double sigma = std::exp(Polynomial(std::array{-0.4803, -0.082676, 0.0030302}, log_n));
  return NormalCdf(-(y - mean) / sigma);
}

void AddMardia(std::span<const Eigen::Vector2d> errors, const Eigen::Matrix2d& information, NormalityTest* test) {
  const auto n = static_cast<double>(errors.size());
  const Eigen::Vector2d mean = MeanOf(errors);
  for (const Eigen::Vector2d& a : errors) {
    const Eigen::RowVector2d weighted = (a - mean).transpose() * information;
    for (const Eigen::Vector2d& b : errors) test->skewness += std::pow(weighted * (b - mean), 3) / (n * n);
    test->kurtosis += std::pow(weighted * (a - mean), 2) / n;
  }
  const double small_sample = 3.0 * (n + 1.0) * (n + 3.0) / (n * (3.0 * (n + 1.0) - 6.0));
  test->skewness_p = ChiSquareUpperTail(test->skewness * small_sample * n / 6.0, 4.0);
  const double z = (test->kurtosis - 8.0 * (n - 1.0) / (n + 1.0)) / std::sqrt(64.0 / n);
  test->kurtosis_p = 2.0 * NormalCdf(-std::abs(z));
}

}  // namespace

std::optional<ShapiroWilk> TestShapiroWilk(std::vector<double> values) {
  const std::size_t n = values.size();
  if (n < 3 || n > kMostForShapiroWilk) return std::nullopt;
  std::sort(values.begin(), values.end());
  if (!(values.front() < values.back())) return std::nullopt;
  const std::vector<double> weights = ShapiroWilkWeights(n);
  double contrast = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) contrast += weights[i] * (values[n - 1 - i] - values[i]);
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double w = std::min(contrast * contrast / squares, 1.0 - 1e-15);
  return ShapiroWilk{w, ShapiroWilkPValue(w, n)};
}

bool NormalityTest::Rejected() const {
  return std::min({p_by_axis.x(), p_by_axis.y(), skewness_p, kurtosis_p}) < 0.05 / 4.0;
}

std::optional<NormalityTest> TestNormality(std::span<const Eigen::Vector2d> errors) {
  if (errors.size() < kFewestForPair) return std::nullopt;
  const std::optional<Eigen::Matrix2d> information = InverseOfSpread(SecondMomentAboutMean(errors));
  if (!information) return std::nullopt;
  NormalityTest test;
  for (const int axis : {0, 1}) {
    std::vector<double> values;
    for (const Eigen::Vector2d& error : errors) values.push_back(error[axis]);
    const std::optional<ShapiroWilk> result = TestShapiroWilk(std::move(values));
    if (!result) return std::nullopt;
    test.w[axis] = result->w;
    test.p_by_axis[axis] = result->p_value;
  }
  AddMardia(errors, *information, &test);
  return test;
}

}  // namespace survey
