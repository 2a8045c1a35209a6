// SPDX-License-Identifier: Apache-2.0
//
// Quantiles of error lengths without any assumption about their distribution, with bounds from order statistics.
#pragma once

#include <optional>
#include <vector>

namespace survey {

struct QuantileEstimate {
  double value = 0.0;              // sample quantile, interpolated between order statistics
  std::optional<double> upper_95;  // one-sided; empty when the sample is too small to bound it (n < 59 for 95 %)
};

// Precondition: `lengths` is not empty, 0 < probability < 1.
QuantileEstimate EstimateQuantile(std::vector<double> lengths, double probability);

}  // namespace survey
