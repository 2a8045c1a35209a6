// SPDX-License-Identifier: Apache-2.0
//
// The map for people as cloud-optimized GeoTIFF.
#include <cpl_string.h>
#include <gdal_priv.h>

#include <cmath>

#include "formats/raster_description.h"
#include "formats/raster_digest.h"
#include "formats/raster_file.h"
#include "formats/scratch_raster.h"

namespace formats {
namespace {

constexpr std::uint8_t kUnknownPercent = 255;
constexpr int kCogTile = 512;

std::uint8_t PercentOf(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownPercent;
  return static_cast<std::uint8_t>(std::lround(100.0 * survey::ProbabilityFromLogOdds(log_odds)));
}

}  // namespace

void WriteCogMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, strips.frame);
  const GdalSession session;
  ScratchRaster scratch(file, strips.frame, session);
  Describe(scratch.data(), strips.frame, label, provenance, "occupancy in percent");
  GDALRasterBand* band = scratch.data()->GetRasterBand(1);
  band->SetNoDataValue(kUnknownPercent);
  band->SetDescription("occupancy");
  band->SetUnitType("percent");
  RasterDigest digest(scratch.data());
  ForEachStrip(strips, &PercentOf, [&](int first_row, std::span<std::uint8_t> rows) {
    scratch.Write(first_row, rows);
    digest.AddRow(std::as_bytes(rows));
  });
  digest.Store(scratch.data());
  scratch.BuildOverviews(kCogTile, kUnknownPercent);
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("BLOCKSIZE", std::to_string(kCogTile).c_str());
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  options.SetNameValue("NUM_THREADS", "1");
  scratch.CopyTo("COG", options.List());
}

void WriteCogMap(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  WriteCogMap(file, survey::StripsOf(raster), label, provenance);
}

}  // namespace formats
