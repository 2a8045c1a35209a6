// SPDX-License-Identifier: Apache-2.0
//
// The route of a block in a scenario file, or what is wrong with it.
#pragma once

#include <filesystem>
#include <string>

#include "survey/simulation/route.h"

namespace formats {

// DataError names the blocks that there are.
const survey::BlockRoute& BlockOfScenario(const std::filesystem::path& file, const survey::Scenario& scenario,
                                          const std::string& name);

// With its trajectory. DataError names the waypoint of a route that cannot be driven.
survey::RoutePlan DrivableRoute(const std::filesystem::path& file, const survey::Scenario& scenario,
                                const survey::BlockRoute& block, const survey::RayCaster& building);

}  // namespace formats
