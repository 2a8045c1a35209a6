// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_facts.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cmath>
#include <vector>

#include "formats/errors.h"
#include "formats/gdal_session.h"

namespace formats {
namespace {

std::string TextOf(const char* text) { return text == nullptr ? "" : text; }

std::string CrsOf(const OGRSpatialReference* crs) {
  if (crs == nullptr) return "none";
  const std::string name = TextOf(crs->GetName());
  const std::string authority = TextOf(crs->GetAuthorityName(nullptr));
  return authority.empty() ? name : name + " (" + authority + ":" + TextOf(crs->GetAuthorityCode(nullptr)) + ")";
}

void ReadValues(GDALRasterBand* band, RasterFacts& facts) {
  int has_nodata = 0;
  const double nodata = band->GetNoDataValue(&has_nodata);
  std::vector<double> row(static_cast<std::size_t>(facts.width));
  double sum = 0.0;
  for (int y = 0; y < facts.height; ++y) {
    if (band->RasterIO(GF_Read, 0, y, facts.width, 1, row.data(), facts.width, 1, GDT_Float64, 0, 0, nullptr) !=
        CE_None)
      return;
    for (const double value : row) {
      if (std::isnan(value) || (has_nodata != 0 && value == nodata)) continue;
      facts.min = facts.num_known == 0 ? value : std::min(facts.min, value);
      facts.max = facts.num_known == 0 ? value : std::max(facts.max, value);
      sum += value;
      ++facts.num_known;
    }
  }
  if (facts.num_known > 0) facts.mean = sum / static_cast<double>(facts.num_known);
}

}  // namespace

RasterFacts ReadRasterFacts(const std::filesystem::path& file) {
  const GdalSession session;
  const char* const drivers[] = {"GTiff", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  RasterFacts facts;
  facts.content = TextOf(data->GetMetadataItem("PLUMBLINE_CONTENT"));
  facts.tied = TextOf(data->GetMetadataItem("PLUMBLINE_TIED"));
  std::array<double, 6> transform{};
  if (facts.content.empty() || data->GetRasterCount() != 1 || data->GetGeoTransform(transform.data()) != CE_None)
    throw DataError(file.string() + ": a GeoTIFF, but not a raster of Plumbline (or damaged)");
  facts.width = data->GetRasterXSize();
  facts.height = data->GetRasterYSize();
  facts.cell_size_m = transform[1];
  facts.west = transform[0];
  facts.north = transform[3];
  facts.east = transform[0] + transform[1] * facts.width;
  facts.south = transform[3] + transform[5] * facts.height;
  facts.crs = CrsOf(data->GetSpatialRef());
  GDALRasterBand* band = data->GetRasterBand(1);
  facts.data_type = GDALGetDataTypeName(band->GetRasterDataType());
  facts.num_overviews = band->GetOverviewCount();
  ReadValues(band, facts);
  session.ThrowIfFailed(file, "cannot be read to its end");
  return facts;
}

}  // namespace formats
