// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_description.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cstdio>

#include "formats/errors.h"
#include "formats/raster_crs.h"
#include "formats/site_metric.h"

namespace formats {
namespace {

// x and y of the outer corner of the upper left cell, as GDAL counts.
std::array<double, 6> GeoTransformOf(const survey::SiteRaster& frame) {
  const double s = frame.cell_size_m;
  return {static_cast<double>(frame.min_column) * s,
          s,
          0.0,
          static_cast<double>(frame.min_row + frame.height) * s,
          0.0,
          -s};
}

void DescribeMetric(GDALDataset* data, const survey::SiteRaster& frame, const RasterLabel& label) {
  const SiteMetric metric = MetricAt(label, frame.CentreOf(frame.width / 2, frame.height / 2));
  data->SetMetadataItem(kDistancesItem, metric.distances.c_str());
  data->SetMetadataItem(kMetricItem, MetricText(metric).c_str());
  if (!metric.scale) return;
  char scale[32];
  std::snprintf(scale, sizeof scale, "%.8f", metric.scale->projection);
  data->SetMetadataItem(kPointScaleItem, scale);
}

}  // namespace

void Describe(GDALDataset* data, const survey::SiteRaster& frame, const RasterLabel& label,
              const Provenance& provenance, const char* content) {
  std::array<double, 6> transform = GeoTransformOf(frame);
  data->SetGeoTransform(transform.data());
  OGRSpatialReference crs;
  crs.importFromWkt(Wkt2OfLabel(label).c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  data->SetSpatialRef(&crs);
  data->SetMetadataItem("AREA_OR_POINT", "Area");
  data->SetMetadataItem(kContentItem, content);
  data->SetMetadataItem(kTiedItem, label.tied ? "yes" : "no");
  if (label.tied && !label.frame.crs.empty()) data->SetMetadataItem(kCrsItem, label.frame.crs.c_str());
  DescribeMetric(data, frame, label);
  data->SetMetadataItem(kProvenanceItem, JsonTextOf(provenance).c_str());
}

void DescribeBand(GDALRasterBand* band, const char* name, const char* unit) {
  band->SetDescription(name);
  band->SetUnitType(unit);
}

void RequireCells(const std::filesystem::path& file, const survey::SiteRaster& frame) {
  if (frame.width <= 0 || frame.height <= 0) throw DataError(file.string() + ": the raster has no cells");
}

}  // namespace formats
