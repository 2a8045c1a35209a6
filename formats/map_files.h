// SPDX-License-Identifier: Apache-2.0
//
// The deliverables of a map (raster_file.h tells what they are), all written from one pass over it.
#pragma once

#include <filesystem>

#include "formats/provenance.h"
#include "formats/raster_file.h"
#include "survey/grid/raster_strips.h"

namespace formats {

// Those with an empty path are not written.
struct MapFiles {
  std::filesystem::path tif;  // as of WriteCogMap
  std::filesystem::path png;  // as of WritePngMap
  std::filesystem::path ros;  // folder, as of WriteRosMap
};

// Strip by strip: memory does not grow with the map's height.
void WriteMapFiles(const MapFiles& files, const survey::RasterStrips& strips, const RasterLabel& label,
                   const Provenance& provenance);

}  // namespace formats
