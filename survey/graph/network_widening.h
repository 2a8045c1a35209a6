// SPDX-License-Identifier: Apache-2.0
//
// Where too few loops tell how good the network's covariances are, control must. An optimistic network would blame good
// marks, so here control may only widen it.
#pragma once

#include "survey/graph/control_misfit.h"

namespace survey {

// Factor, at least 1, for the covariances of the network under which the median of the marks' T is that of its
// distribution (1.386): up to almost half of the marks may be blunders. 1 with fewer than five marks.
double WideningFactor(const ControlMisfit& misfit);

}  // namespace survey
