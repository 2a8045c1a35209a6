// SPDX-License-Identifier: Apache-2.0
//
// The list of sphere targets: target,northing,easting,elevation,sigma_m,radius_m.
#pragma once

#include <filesystem>
#include <vector>

#include "survey/cloud/target_fit.h"

namespace formats {

struct TargetList {
  std::vector<survey::KnownTarget> targets;
  double radius_m = 0.0;  // the same for all
};

// DataError names file, row, field, value and rule.
TargetList ReadTargetsCsv(const std::filesystem::path& file);

}  // namespace formats
