// SPDX-License-Identifier: Apache-2.0
//
// A checkout of a site's edits for QGIS: a GeoPackage that is ready to draw in (styles, forms and constraints in
// layer_styles), and what was drawn in it since. README.md, "Map edits".
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "formats/edit_ledger.h"
#include "formats/provenance.h"
#include "formats/raster_file.h"
#include "survey/edits/map_edit.h"

namespace formats {

// `edits` lie where the maps put them now; `basis` are these maps. Squares of cells and bundles of arrows are left out:
// nobody draws them in QGIS.
void WriteEditPackage(const std::filesystem::path& file, const std::vector<survey::MapEdit>& edits,
                      const std::map<std::string, std::string>& basis, const RasterLabel& label);

// What was changed since the checkout, by uid: features that moved or whose attributes changed are modified, those that
// are gone retired, new ones added. Empty when the file was only looked at. who, when and tool are left to the caller.
// DataError names file, layer and feature, and what of edit_json.h's rules it breaks.
std::vector<LedgerLine> ReadEditPackage(const std::filesystem::path& file);

}  // namespace formats
