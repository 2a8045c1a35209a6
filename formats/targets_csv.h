// SPDX-License-Identifier: Apache-2.0
//
// The list of targets: target,northing,easting,elevation,sigma_m,radius_m. A radius of 0: the centre of a checkerboard.
#pragma once

#include <filesystem>
#include <vector>

#include "survey/cloud/target_fit.h"

namespace formats {

struct TargetList {
  std::vector<survey::KnownTarget> targets;
  double radius_m = 0.0;  // of all spheres; 0 where there are none
  bool has_boards = false;
};

// DataError names file, row, field, value and rule.
TargetList ReadTargetsCsv(const std::filesystem::path& file);

}  // namespace formats
