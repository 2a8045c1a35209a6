// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_facts.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_description.h"
#include "formats/raster_digest.h"

namespace formats {
namespace {

std::string TextOf(const char* text) { return text == nullptr ? "" : text; }

std::string CrsOf(const OGRSpatialReference* crs) {
  if (crs == nullptr) return "none";
  const std::string name = TextOf(crs->GetName());
  const std::string authority = TextOf(crs->GetAuthorityName(nullptr));
  return authority.empty() ? name : name + " (" + authority + ":" + TextOf(crs->GetAuthorityCode(nullptr)) + ")";
}

void AddValues(std::span<const double> values, double nodata, RasterFacts& facts) {
  for (const double value : values) {
    if (std::isnan(value) || value == nodata) continue;
    facts.min = facts.num_known == 0 ? value : std::min(facts.min, value);
    facts.max = facts.num_known == 0 ? value : std::max(facts.max, value);
    facts.mean += (value - facts.mean) / static_cast<double>(++facts.num_known);
  }
}

// False when the band cannot be read to its end.
bool ReadValues(GDALRasterBand* band, RasterDigest& digest, RasterFacts& facts) {
  const double nodata = band->GetNoDataValue();
  const GDALDataType type = band->GetRasterDataType();
  const auto width = static_cast<std::size_t>(facts.width);
  std::vector<std::byte> row(width * static_cast<std::size_t>(GDALGetDataTypeSizeBytes(type)));
  std::vector<double> values(width);
  for (int y = 0; y < facts.height; ++y) {
    if (band->RasterIO(GF_Read, 0, y, facts.width, 1, row.data(), facts.width, 1, type, 0, 0, nullptr) != CE_None)
      return false;
    digest.AddRows(band->GetBand(), row);
    GDALCopyWords(row.data(), type, GDALGetDataTypeSizeBytes(type), values.data(), GDT_Float64, sizeof(double),
                  facts.width);
    AddValues(values, nodata, facts);
  }
  return true;
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
  if (facts.content.empty() || data->GetRasterCount() > 3 || data->GetGeoTransform(transform.data()) != CE_None)
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
  RasterDigest digest(data.get());
  bool whole = ReadValues(band, digest, facts);
  for (int side = 2; side <= data->GetRasterCount(); ++side) {
    band = data->GetRasterBand(side);
    RasterFacts of_side{.width = facts.width, .height = facts.height};
    whole = whole && ReadValues(band, digest, of_side);
    if (TextOf(band->GetDescription()) != kSigmaName) continue;
    const double scale = band->GetScale();
    facts.sigma_m = {scale * of_side.min, scale * of_side.mean, scale * of_side.max};
  }
  if (whole) digest.Verify(data.get(), file);
  session.ThrowIfFailed(file, "cannot be read to its end");
  return facts;
}

}  // namespace formats
