// SPDX-License-Identifier: Apache-2.0
//
// Scenarios of `simulate` as TOML (all keys: examples/parking-garage/README.md). Survey units here (degrees, deg/h,
// mGal), SI inside.
#pragma once

#include <filesystem>

#include "survey/simulation/scenario.h"

namespace formats {

// DataError names file, line, key, value and rule; unknown tables and keys are errors.
survey::Scenario ReadScenario(const std::filesystem::path& file);

}  // namespace formats
