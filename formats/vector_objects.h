// SPDX-License-Identifier: Apache-2.0
//
// Forbidden areas as the shapes of a Nav2 Vector Object server (ROS 2 parameters).
#pragma once

#include <filesystem>
#include <vector>

#include "survey/edits/map_edit.h"
#include "survey/grid/site_raster.h"

namespace formats {

// Metres from the lower left corner of `frame`, as map_local.yaml has it: the server keeps positions as 32-bit floats.
// Holes of areas are left out: robots keep out of them too.
void WriteVectorObjects(const std::filesystem::path& file, const std::vector<survey::MapEdit>& forbidden,
                        const survey::SiteRaster& frame);

}  // namespace formats
