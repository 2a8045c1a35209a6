// SPDX-License-Identifier: Apache-2.0
#include "survey/network/outliers.h"

#include <cmath>

#include "survey/network/network_checks.h"

namespace survey {
namespace {

// Index of the observation with the largest |w|; results in the order of `kept`.
std::size_t Worst(const NetworkAdjustment& adjustment) {
  std::size_t worst = 0;
  for (std::size_t k = 0; k < adjustment.observations.size(); ++k) {
    if (std::abs(adjustment.observations[k].w) > std::abs(adjustment.observations[worst].w)) worst = k;
  }
  return worst;
}

}  // namespace

std::vector<SuspectedOutlier> FindOutliers(const Network& network, const NetworkAdjustment& adjustment,
                                           const AdjustmentOptions& options, std::size_t limit) {
  std::vector<SuspectedOutlier> outliers;
  const double critical = CriticalW(options.test.significance);
  std::vector<bool> out(network.observations.size(), false);
  const std::vector<bool> no_points(network.points.size(), false);
  std::vector<std::size_t> kept(network.observations.size());
  for (std::size_t k = 0; k < kept.size(); ++k) kept[k] = k;
  NetworkAdjustment without = adjustment;
  while (outliers.size() < limit && without.usable && without.largest_w > critical) {
    const std::size_t worst = Worst(without);
    outliers.push_back({kept[worst], without.observations[worst].w, without.observations[worst].estimated_error});
    out[kept[worst]] = true;
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(worst));
    if (without.degrees_of_freedom <= 1) break;
    without = AdjustNetwork(Without(network, no_points, out), options);
  }
  return outliers;
}

}  // namespace survey
