// SPDX-License-Identifier: Apache-2.0
//
// Map edits as people draw them (review page, QGIS): GeoJSON feature collections of LineString and Polygon in site
// coordinates with the properties state (occupied, free, unknown), width_m (lines), who, why.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/edits/map_edit.h"

namespace formats {

// In file order. DataError names file and feature (counted from 1): unknown kind or property, missing state, a number
// that is none, too few corners, an area that crosses itself, a `crs` member other than the site's.
std::vector<survey::MapEdit> ReadEdits(const std::filesystem::path& file, const std::string& site_crs);

}  // namespace formats
