// SPDX-License-Identifier: Apache-2.0
//
// The part of a control network that the adjustment of one block may see. Check and excluded points are never in it:
// that is what makes them independent.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "survey/control/control_point.h"

namespace survey {

// Null when the network has no point of that name.
const ControlPoint* FindPoint(const ControlNetwork& network, const std::string& name);

// The control and tie points among `marked` (names in any order, repeated or not), in order of their names, with the
// covariances between them and nothing else.
ControlNetwork ExtractOfBlock(const ControlNetwork& network, const std::vector<std::string>& marked);

// Adds points whose names are new, keeping the order and the correlations.
void AddPoints(const std::vector<ControlPoint>& points, ControlNetwork* network);

// Names of a check point and the control point that is the same place (nearer than `distance_m`): no check at all.
std::vector<std::pair<std::string, std::string>> ChecksOnControl(const ControlNetwork& network, double distance_m);

// Up to `count` point names nearest to a misspelled one (edit distance, upper and lower case alike), nearest first;
// only those that less than half of the letters separate.
std::vector<std::string> SimilarNames(const ControlNetwork& network, const std::string& name, std::size_t count);

}  // namespace survey
