// SPDX-License-Identifier: Apache-2.0
//
// Map edits as people draw them in a GIS or by hand: GeoJSON feature collections in site coordinates, whose properties
// are the members of an edit (edit_json.h). They are taken over into the ledger.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/edits/map_edit.h"

namespace formats {

// In file order. DataError names file and feature (counted from 1) and the rule of edit_json.h that it breaks, or a
// `crs` member other than the site's.
std::vector<survey::MapEdit> ReadEdits(const std::filesystem::path& file, const std::string& site_crs);

}  // namespace formats
