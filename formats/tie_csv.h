// SPDX-License-Identifier: Apache-2.0
//
// Points that are known both in the site grid and in the projected system: header point,x,y,easting,northing (m; x to
// the right of y, seen from above).
#pragma once

#include <filesystem>
#include <vector>

#include "survey/control/site_tie.h"

namespace formats {

// DataError names file, row, value and rule.
std::vector<survey::TiePoint> ReadTieCsv(const std::filesystem::path& file);

}  // namespace formats
