// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "survey/features/feature.h"

namespace formats {

// control/features.csv: name,northing,easting,sigma_n,sigma_e,kind (corner or pillar), in file order. DataError names
// row, field, value and rule: numbers, sigmas that are not negative, unique names.
std::vector<survey::NamedFeature> ReadFeaturesCsv(const std::filesystem::path& file);

}  // namespace formats
