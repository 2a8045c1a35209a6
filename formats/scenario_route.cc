// SPDX-License-Identifier: Apache-2.0
#include "formats/scenario_route.h"

#include "formats/errors.h"

namespace formats {

const survey::BlockRoute& BlockOfScenario(const std::filesystem::path& file, const survey::Scenario& scenario,
                                          const std::string& name) {
  std::string known;
  for (const survey::BlockRoute& block : scenario.blocks) {
    if (block.name == name) return block;
    known += (known.empty() ? "" : ", ") + block.name;
  }
  throw DataError(file.string() + ": has no block \"" + name + "\"; it has " + known);
}

survey::RoutePlan DrivableRoute(const std::filesystem::path& file, const survey::Scenario& scenario,
                                const survey::BlockRoute& block, const survey::RayCaster& building) {
  survey::RoutePlan route = survey::PlanRoute(scenario, block, building);
  if (route.trajectory) return route;
  throw DataError(file.string() + ": block " + block.name + ": waypoint " + std::to_string(route.problem_waypoint) +
                  " " + route.problem);
}

}  // namespace formats
