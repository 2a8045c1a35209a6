// SPDX-License-Identifier: Apache-2.0
//
// Layers as GeoPackage for GIS, with styles that QGIS applies by itself, and as DXF for CAD. Equal layers give equal
// bytes: all dates in the GeoPackage are 1970-01-01.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/provenance.h"
#include "formats/raster_file.h"
#include "formats/site_vectors.h"

namespace formats {

// The provenance stands in the metadata item PLUMBLINE_PROVENANCE.
void WriteGeoPackage(const std::filesystem::path& file, const std::vector<VectorLayer>& layers,
                     const RasterLabel& label, const Provenance& provenance);

// A DXF layer for each layer, with names as texts; metres, without a coordinate system.
void WriteDxf(const std::filesystem::path& file, const std::vector<VectorLayer>& layers);

}  // namespace formats
