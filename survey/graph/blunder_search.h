// SPDX-License-Identifier: Apache-2.0
//
// Which marks on control points the others contradict: data snooping [Baarda68], one at a time, with the single mark,
// all marks of a point (its coordinates) and the exchange of two marks as hypotheses. What is left out is tried again
// at the end. Marks contradict the map as a whole where more than half of the points would have to go, or where the
// distance of the two points that are left is not that of the map: neither of them can be blamed.
#pragma once

#include <utility>
#include <vector>

#include "survey/graph/control_misfit.h"

namespace survey {

struct BlunderSearch {
  std::vector<int> kept;                       // places in the misfit, ascending
  std::vector<int> excluded;                   // in the order in which they were found
  std::vector<std::pair<int, int>> exchanged;  // among the excluded: one of each wears the other's label
  bool contradicted = false;                   // too few would be left to tell which are wrong: all are kept
  double critical_t = 0.0;                     // beyond it a mark was left out; never below that of a single test
};

// `family_significance`: probability that a block without blunders loses a mark.
BlunderSearch SearchBlunders(const ControlMisfit& misfit, double family_significance);

}  // namespace survey
