// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/network_widening.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "survey/graph/control_tests.h"

namespace survey {
namespace {

constexpr int kFewestMarks = 5;
constexpr std::size_t kFewestToFix = 3;  // two hold the datum and little more
constexpr double kLargestFactor = 1e6;

// What the tests of marks need, with the network's covariance multiplied.
ControlMisfit WithNetwork(const ControlMisfit& misfit, double factor) {
  return {.marks = misfit.marks,
          .misfit = misfit.misfit,
          .of_network = factor * misfit.of_network,
          .of_marks = misfit.of_marks,
          .of_control = misfit.of_control,
          .datum = misfit.datum};
}

double MedianT(const ControlMisfit& misfit, double factor) {
  const ControlMisfit scaled = WithNetwork(misfit, factor);
  std::vector<int> all(static_cast<std::size_t>(misfit.size()));
  std::iota(all.begin(), all.end(), 0);
  const ControlTests tests(scaled, all);
  if (!tests.usable()) return 0.0;
  std::vector<double> t;
  for (const int mark : all) t.push_back(tests.Test(std::span(&mark, 1), {}).t);
  const auto middle = t.begin() + static_cast<std::ptrdiff_t>(t.size() / 2);
  std::nth_element(t.begin(), middle, t.end());
  return *middle;
}

ControlTests::Component OfNetwork(const ControlMisfit& misfit, const std::vector<int>& kept, double factor) {
  const ControlMisfit scaled = WithNetwork(misfit, factor);
  const ControlTests tests(scaled, kept);
  return tests.usable() ? tests.ComponentOfNetwork() : ControlTests::Component{};
}

// The logarithm between `low` and `high` where `beyond` becomes true.
template <typename Predicate>
double Turn(double low, double high, const Predicate& beyond) {
  for (int step = 0; step < 24; ++step) {
    const double middle = (low + high) / 2.0;
    (beyond(std::exp(middle)) ? high : low) = middle;
  }
  return high;
}

}  // namespace

double WideningFactor(const ControlMisfit& misfit) {
  if (misfit.size() < kFewestMarks) return 1.0;
  const double median = CriticalT(0.5, 2);
  if (MedianT(misfit, 1.0) <= median) return 1.0;
  return std::exp(
      Turn(0.0, std::log(kLargestFactor), [&](double factor) { return MedianT(misfit, factor) <= median; }));
}

double FactorByMarks(const ControlMisfit& misfit, const std::vector<int>& kept, double conditions) {
  if (kept.size() < kFewestToFix) return 1.0;
  const auto beyond = [&](double factor) {
    const ControlTests::Component network = OfNetwork(misfit, kept, factor);
    return network.redundancy - network.squares + conditions * std::log(factor) > 0.0;
  };
  const double factor = std::exp(Turn(-std::log(kLargestFactor), std::log(kLargestFactor), beyond));
  const double told = conditions + OfNetwork(misfit, kept, factor).redundancy;
  return factor * std::exp(3.0 / told);  // 2 F(0.95; 2, told) by chi-square, within 3 %
}

}  // namespace survey
