// SPDX-License-Identifier: Apache-2.0
//
// The tests of a solution's control as text, for `show`.
#pragma once

#include <ostream>

#include "survey/graph/solution.h"

namespace formats {

// Nothing for a block in its local frame.
void PrintReliability(const survey::Solution& solution, std::ostream& out);

}  // namespace formats
