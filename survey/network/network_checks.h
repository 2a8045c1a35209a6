// SPDX-License-Identifier: Apache-2.0
//
// What can be said of a network before it is adjusted: points that nothing leads to, one-sided observations. (What only
// the equations show, a network without datum or a singular configuration, AdjustNetwork names.)
#pragma once

#include <string>
#include <vector>

#include "survey/network/network.h"

namespace survey {

struct NetworkDefect {
  std::vector<int> points;  // that are not determined
  std::string message;      // names them
};

// Each point in at most one of them; empty when nothing is wrong.
std::vector<NetworkDefect> CheckNetwork(const Network& network);

// The network without some observations and points; indices of points do not change (they become unused), sets are
// numbered anew.
Network Without(const Network& network, const std::vector<bool>& points, const std::vector<bool>& observations);

// "A", "A, B and C", or the first eight "and 12 more".
std::string ListedNames(const Network& network, const std::vector<int>& points);

}  // namespace survey
