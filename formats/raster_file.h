// SPDX-License-Identifier: Apache-2.0
//
// Occupancy rasters on disk. Intermediates (grid.tif, map.tif): Float32 log-odds, NaN where never observed.
// Deliverables: site.tif (COG, Byte 0-100 = occupancy in percent, 255 = unknown), PNG + world file + .aux.xml, ROS
// map_server yaml + pgm.
#pragma once

#include <filesystem>
#include <string>

#include "formats/provenance.h"
#include "survey/control/control_point.h"
#include "survey/grid/raster_strips.h"
#include "survey/grid/site_raster.h"

namespace formats {

// `tied` false: the raster is in a local frame and is plainly labelled "not tied to control" in its CRS name and
// metadata.
struct RasterLabel {
  survey::SiteFrame frame;
  bool tied = false;
};

void WriteRaster(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance);
void WriteRaster(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance);
survey::SiteRaster ReadRaster(const std::filesystem::path& file, RasterLabel* label = nullptr);

// The same for rasters that need not fit into memory: the file is checked whole, its rows are read when asked for.
survey::RasterStrips OpenRaster(const std::filesystem::path& file, RasterLabel* label);

// All writers take a raster strip by strip: memory does not grow with its height.

// GeoTIFF for people: cloud-optimized, DEFLATE, 512-cell tiles, overviews, nodata 255.
void WriteCogMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance);
void WriteCogMap(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance);

// Picture: white free, black occupied, grey unknown; writes file, the .pgw beside it (centre of the upper left pixel)
// and file.aux.xml with the CRS.
void WritePngMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label);
void WritePngMap(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label);

// folder/map.pgm with map.yaml (origin = lower left corner in site coordinates) and map_local.yaml (the same picture,
// lower left corner at 0 0: ROS tools keep positions as 32-bit floats); free_thresh 0.196 so that unknown stays
// unknown.
void WriteRosMap(const std::filesystem::path& folder, const survey::RasterStrips& strips, const RasterLabel& label);
void WriteRosMap(const std::filesystem::path& folder, const survey::SiteRaster& raster, const RasterLabel& label);

// folder/keepout.pgm, keepout.yaml and keepout_local.yaml: the same for a mask that is "occupied" where robots must not
// go (survey/edits/keepout.h).
void WriteKeepoutMask(const std::filesystem::path& folder, const survey::RasterStrips& strips,
                      const RasterLabel& label);

// Cells of any GeoTIFF of Plumbline: size and place, without their values.
survey::SiteRaster ReadRasterFrame(const std::filesystem::path& file, RasterLabel* label);

// WKT2 of "EPSG:25832" and the like; empty for empty. UsageError names a CRS that is not known or not projected.
std::string Wkt2OfCrs(const std::string& crs);

}  // namespace formats
