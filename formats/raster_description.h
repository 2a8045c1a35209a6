// SPDX-License-Identifier: Apache-2.0
//
// What every GeoTIFF of Plumbline says of itself beside its cells: georeference, CRS, tied or not, metric,
// content, provenance.
#pragma once

#include "formats/provenance.h"
#include "formats/raster_file.h"
#include "survey/grid/site_raster.h"

class GDALDataset;
class GDALRasterBand;

namespace formats {

inline constexpr const char* kProvenanceItem = "PLUMBLINE_PROVENANCE";
inline constexpr const char* kTiedItem = "PLUMBLINE_TIED";
inline constexpr const char* kCrsItem = "PLUMBLINE_CRS";
inline constexpr const char* kContentItem = "PLUMBLINE_CONTENT";
inline constexpr const char* kDistancesItem = "PLUMBLINE_DISTANCES";
inline constexpr const char* kMetricItem = "PLUMBLINE_METRIC";
inline constexpr const char* kPointScaleItem = "PLUMBLINE_POINT_SCALE";

void Describe(GDALDataset* data, const survey::SiteRaster& frame, const RasterLabel& label,
              const Provenance& provenance, const char* content);

inline constexpr const char* kSigmaName = "positional uncertainty, 1 sigma in the worst direction";

void DescribeBand(GDALRasterBand* band, const char* name, const char* unit);

// DataError when there are none: GDAL has no empty rasters.
void RequireCells(const std::filesystem::path& file, const survey::SiteRaster& frame);

}  // namespace formats
