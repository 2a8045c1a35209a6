// SPDX-License-Identifier: Apache-2.0
//
// A scenario as a picture: building, cars, glass, people's paths, the blocks' true ways with their marks, control,
// check points and features.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/simulation/floor_plan.h"
#include "survey/simulation/scenario.h"

namespace formats {

struct DrawnRoute {
  std::string name;
  survey::Polyline way;  // plan frame
};

// PNG, north up, black on white.
void WriteScenarioPicture(const std::filesystem::path& file, const survey::Scenario& scenario,
                          const survey::FloorPlan& plan, const std::vector<DrawnRoute>& routes);

}  // namespace formats
