// SPDX-License-Identifier: Apache-2.0
//
// The adjustment of a control network as surveyors know it from other programs: summary with the test of sigma zero,
// points with their standard deviations and error ellipses, observations with residuals, tests and reliability.
#pragma once

#include <ostream>

#include "survey/control/control_point.h"

namespace formats {

// Nothing when the points were not adjusted.
void PrintNetworkReport(const survey::ControlNetwork& network, std::ostream& out);

}  // namespace formats
