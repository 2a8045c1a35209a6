// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace survey {

bool NormalizeLogWeights(std::vector<double>* log_weights) {
  double largest = -std::numeric_limits<double>::infinity();
  for (double& value : *log_weights) {
    if (std::isnan(value)) value = -std::numeric_limits<double>::infinity();
    largest = std::max(largest, value);
  }
  if (!std::isfinite(largest)) {
    std::fill(log_weights->begin(), log_weights->end(), -std::log(static_cast<double>(log_weights->size())));
    return false;
  }
  double sum = 0.0;
  for (const double value : *log_weights) sum += std::exp(value - largest);
  for (double& value : *log_weights) value -= largest + std::log(sum);
  return true;
}

double EffectiveSampleSize(std::span<const double> log_weights) {
  double squares = 0.0;
  for (const double value : log_weights) squares += std::exp(2.0 * value);
  return 1.0 / squares;
}

std::vector<int> SystematicResampling(std::span<const double> log_weights, double uniform) {
  const auto count = static_cast<double>(log_weights.size());
  std::vector<int> parents;
  double cumulated = std::exp(log_weights[0]);
  std::size_t parent = 0;
  for (std::size_t i = 0; i < log_weights.size(); ++i) {
    const double tooth = (static_cast<double>(i) + uniform) / count;
    while (cumulated <= tooth && parent + 1 < log_weights.size()) cumulated += std::exp(log_weights[++parent]);
    parents.push_back(static_cast<int>(parent));
  }
  return parents;
}

}  // namespace survey
