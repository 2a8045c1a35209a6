// SPDX-License-Identifier: Apache-2.0
//
// The level of evidence between "tested" and "fit": each control point against where all others put it (leave one out).
// The map was drawn with the point, so this is no test on independent points; but the point's own coordinates have no
// part in its error, which the residuals of a fit cannot say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "survey/accuracy/control_reliability.h"
#include "survey/accuracy/error_statistics.h"
#include "survey/control/control_point.h"

namespace survey {

struct CrossValidation {
  ErrorStatistics statistics;  // of place by the others minus given; the references are the control points
  // Mean of d' C^-1 d / 2, C the covariance of d: 1 where the sigmas are honest. Not of independent values.
  std::optional<double> normalised_square;
  std::string sentence;  // for people
};

// Of the used marks whose point is marked once in its block: a second mark would bring the point's coordinates back.
// Empty where no mark is controlled by others.
std::optional<CrossValidation> CrossValidate(const std::vector<BlockReliability>& blocks,
                                             const ControlNetwork& network);

}  // namespace survey
