// SPDX-License-Identifier: Apache-2.0
//
// Approximate coordinates of points that come without: polar points, intersections, resections, free stations,
// traverses, distances; where that ends, local pieces are computed in a system of their own and joined by a similarity
// transformation. Then heights, levelled and trigonometric.
#pragma once

#include <vector>

#include "survey/network/network.h"

namespace survey {

// Fills in positions; returns the points in use that the observations do not lead to, in order. Geocentric networks
// must have all coordinates.
std::vector<int> ComputeApproximations(Network* network);

}  // namespace survey
