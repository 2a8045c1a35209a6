// SPDX-License-Identifier: Apache-2.0
//
// Where too few loops tell how good the network's covariances are, control must. An optimistic network would blame good
// marks, so before the search for blunders control may only widen it; by the marks that are left afterwards it may
// narrow it: what the map is worth would otherwise stay hidden behind sigmas that no loop has confirmed.
#pragma once

#include <vector>

#include "survey/graph/control_misfit.h"

namespace survey {

// Factor, at least 1, for the covariances of the network under which the median of the marks' T is that of its
// distribution (1.386): up to almost half of the marks may be blunders. 1 with fewer than five marks.
double WideningFactor(const ControlMisfit& misfit);

// Factor, at most 1, for the covariances of the network by its variance component [Foerstner79] in the conditions of
// the marks `kept` (places in the misfit). The covariances as they are count as much as `conditions`.
double NarrowingFactor(const ControlMisfit& misfit, const std::vector<int>& kept, double conditions);

}  // namespace survey
