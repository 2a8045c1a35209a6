// SPDX-License-Identifier: Apache-2.0
//
// Data snooping [Baarda68]: the observation with the largest |w| beyond the critical value is suspected, the rest
// adjusted without it, and so on, one at a time, since one blunder shows in many residuals.
#pragma once

#include <cstddef>
#include <vector>

#include "survey/network/adjustment.h"

namespace survey {

struct SuspectedOutlier {
  std::size_t observation = 0;   // index in the network
  double w = 0.0;                // in the adjustment in which it was the worst
  double estimated_error = 0.0;  // of the observation, m or rad
};

// In the order in which they are found; `adjustment` is that of the whole network. At most `limit`.
std::vector<SuspectedOutlier> FindOutliers(const Network& network, const NetworkAdjustment& adjustment,
                                           const AdjustmentOptions& options, std::size_t limit);

}  // namespace survey
