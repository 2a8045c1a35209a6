// SPDX-License-Identifier: Apache-2.0
//
// Where too few loops tell how good the network's covariances are, control must. An optimistic network would blame good
// marks, so before the search for blunders control may only widen it. By the marks that are left afterwards it gets the
// factor that they tell, often a smaller one: what the map is worth would otherwise stay hidden behind sigmas that
// nothing has confirmed.
#pragma once

#include <vector>

#include "survey/graph/control_misfit.h"

namespace survey {

// Factor, at least 1, for the covariances of the network under which the median of the marks' T is that of its
// distribution (1.386): up to almost half of the marks may be blunders. 1 with fewer than five marks.
double WideningFactor(const ControlMisfit& misfit);

// Factor for the covariances of the network by its variance component [Foerstner79] in the conditions of the marks
// `kept` (places in the misfit), where the covariances as they are count as `conditions`. So much larger that ellipses
// of 95 % by the chi-square distribution hold what those by Fisher's would with so many conditions. 1 with fewer than
// three marks.
double FactorByMarks(const ControlMisfit& misfit, const std::vector<int>& kept, double conditions);

}  // namespace survey
