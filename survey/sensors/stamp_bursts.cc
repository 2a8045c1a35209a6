// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/stamp_bursts.h"

#include <algorithm>

namespace survey {
namespace {

constexpr double kManyEqual = 0.05;
constexpr double kMostInBursts = 0.8;
constexpr std::size_t kFewestStamps = 20;

// Stamps [begin, end) that stand together.
struct Burst {
  std::size_t begin;
  std::size_t end;
  std::size_t size() const { return end - begin; }
};

std::vector<Burst> BurstsOf(const std::vector<StampNs>& stamps, StampNs longest_step) {
  std::vector<Burst> bursts;
  for (std::size_t begin = 0; begin < stamps.size();) {
    std::size_t end = begin + 1;
    while (end < stamps.size() && stamps[end] >= stamps[end - 1] && stamps[end] - stamps[end - 1] <= longest_step)
      ++end;
    bursts.push_back({begin, end});
    begin = end;
  }
  return bursts;
}

StampNs Median(std::vector<StampNs> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The step between the stamps of each burst, were they even: to the next burst, or from the one before.
std::vector<StampNs> EvenSteps(const std::vector<StampNs>& stamps, const std::vector<Burst>& bursts, bool forward) {
  std::vector<StampNs> steps(bursts.size(), 0);
  std::vector<StampNs> known;
  for (std::size_t k = 0; k < bursts.size(); ++k) {
    const auto size = static_cast<StampNs>(bursts[k].size());
    if (forward && k + 1 < bursts.size()) steps[k] = (stamps[bursts[k + 1].begin] - stamps[bursts[k].begin]) / size;
    if (!forward && k > 0) steps[k] = (stamps[bursts[k].end - 1] - stamps[bursts[k - 1].end - 1]) / size;
    if (steps[k] > 0) known.push_back(steps[k]);
  }
  const StampNs usual = Median(known);
  for (StampNs& step : steps) step = step > 0 ? std::min(step, 2 * usual) : usual;
  return steps;
}

}  // namespace

double ShareOfEqual(const std::vector<StampNs>& stamps) {
  std::size_t equal = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) equal += stamps[i] == stamps[i - 1] ? 1 : 0;
  return stamps.empty() ? 0.0 : static_cast<double>(equal) / static_cast<double>(stamps.size());
}

std::vector<StampNs> SpreadBursts(const std::vector<StampNs>& stamps) {
  if (stamps.size() < kFewestStamps || stamps.back() <= stamps.front()) return {};
  const bool equal = ShareOfEqual(stamps) > kManyEqual;
  const auto count = static_cast<StampNs>(stamps.size());
  const StampNs longest_step = equal ? 0 : (stamps.back() - stamps.front()) / (10 * count);
  const std::vector<Burst> bursts = BurstsOf(stamps, longest_step);
  const double in_bursts = 1.0 - static_cast<double>(bursts.size()) / static_cast<double>(count);
  if (!equal && in_bursts < kMostInBursts) return {};
  const std::vector<StampNs> steps = EvenSteps(stamps, bursts, equal);
  std::vector<StampNs> repairs(stamps.size(), 0);
  for (std::size_t k = 0; k < bursts.size(); ++k) {
    const Burst& burst = bursts[k];
    for (std::size_t i = burst.begin; i < burst.end; ++i) {
      const StampNs even = equal ? stamps[burst.begin] + static_cast<StampNs>(i - burst.begin) * steps[k]
                                 : stamps[burst.end - 1] - static_cast<StampNs>(burst.end - 1 - i) * steps[k];
      repairs[i] = even - stamps[i];
    }
  }
  return repairs;
}

}  // namespace survey
