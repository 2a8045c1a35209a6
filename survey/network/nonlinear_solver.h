// SPDX-License-Identifier: Apache-2.0
//
// From approximate coordinates to the minimum of the weighted squares: Ceres (Levenberg-Marquardt), which also finds
// its way from rough approximations. The residuals are those of LinearSystem with the opposite sign.
#pragma once

#include <string>
#include <vector>

#include "survey/network/linear_system.h"

namespace survey {

struct NonlinearSummary {
  bool usable = false;
  int iterations = 0;
  std::string message;
};

// Moves all unknowns of `state` but the held ones.
NonlinearSummary SolveNonlinear(const Network& network, const std::vector<ObservationGroup>& groups,
                                const Unknowns& unknowns, const std::vector<int>& held, NetworkState* state);

}  // namespace survey
