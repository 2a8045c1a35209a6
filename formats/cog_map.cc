// SPDX-License-Identifier: Apache-2.0
//
// The map for people as cloud-optimized GeoTIFF.
#include <cpl_string.h>
#include <gdal_priv.h>

#include "formats/map_codes.h"
#include "formats/raster_description.h"
#include "formats/raster_digest.h"
#include "formats/raster_file.h"
#include "formats/scratch_raster.h"

namespace formats {
namespace {

constexpr int kCogTile = 512;

}  // namespace

void WriteCogMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, strips.frame);
  const GdalSession session;
  ScratchRaster scratch(file, strips.frame, strips.has_sigma ? 2 : 1, session);
  Describe(scratch.data(), strips.frame, label, provenance, "occupancy in percent");
  RasterDigest digest(scratch.data());
  const auto fill = [&](int band, Layer layer, CellCode code) {
    scratch.data()->GetRasterBand(band)->SetNoDataValue(kUnknownCode);
    ForEachStrip(strips, layer, code, [&](int first_row, std::span<std::uint8_t> rows) {
      scratch.Write(band, first_row, rows);
      digest.AddRow(std::as_bytes(rows));
    });
  };
  fill(1, &survey::SiteRaster::log_odds, &PercentOf);
  DescribeBand(scratch.data()->GetRasterBand(1), "occupancy", "percent");
  if (strips.has_sigma) {
    fill(2, &survey::SiteRaster::sigma_m, &SigmaStepsOf);
    DescribeBand(scratch.data()->GetRasterBand(2), kSigmaName, "m");
    scratch.data()->GetRasterBand(2)->SetScale(kSigmaStep_m);
  }
  digest.Store(scratch.data());
  scratch.BuildOverviews(kCogTile, kUnknownCode);
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
