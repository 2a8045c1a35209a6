// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/network_widening.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "survey/graph/control_tests.h"

namespace survey {
namespace {

constexpr int kFewestMarks = 5;
constexpr double kLargestFactor = 1e6;

double MedianT(ControlMisfit misfit, double factor) {
  misfit.of_network *= factor;
  std::vector<int> all(static_cast<std::size_t>(misfit.size()));
  std::iota(all.begin(), all.end(), 0);
  const ControlTests tests(misfit, all);
  if (!tests.usable()) return 0.0;
  std::vector<double> t;
  for (const int mark : all) t.push_back(tests.Test(std::span(&mark, 1), {}).t);
  const auto middle = t.begin() + static_cast<std::ptrdiff_t>(t.size() / 2);
  std::nth_element(t.begin(), middle, t.end());
  return *middle;
}

}  // namespace

double WideningFactor(const ControlMisfit& misfit) {
  if (misfit.size() < kFewestMarks) return 1.0;
  const double median = CriticalT(0.5, 2);
  double low = 0.0;  // logarithms
  double high = std::log(kLargestFactor);
  if (MedianT(misfit, 1.0) <= median) return 1.0;
  for (int step = 0; step < 20; ++step) {
    const double middle = (low + high) / 2.0;
    (MedianT(misfit, std::exp(middle)) > median ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace survey
