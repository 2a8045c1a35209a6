// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/error_quantile.h"

#include <algorithm>
#include <cmath>

#include "survey/accuracy/distributions.h"

namespace survey {

QuantileEstimate EstimateQuantile(std::vector<double> lengths, double probability) {
  std::sort(lengths.begin(), lengths.end());
  const auto n = static_cast<int>(lengths.size());
  const double place = probability * (n - 1);
  const auto below = static_cast<std::size_t>(std::floor(place));
  const std::size_t above = std::min(below + 1, lengths.size() - 1);
  const double fraction = place - std::floor(place);
  QuantileEstimate estimate{.value = (1.0 - fraction) * lengths[below] + fraction * lengths[above]};
  // The r-th smallest bounds the quantile from above when at 95 % no smaller share than `probability` lies below it.
  for (int r = 1; r <= n; ++r) {
    if (BetaQuantile(0.05, r, n - r + 1.0) < probability) continue;
    estimate.upper_95 = lengths[static_cast<std::size_t>(r - 1)];
    break;
  }
  return estimate;
}

}  // namespace survey
