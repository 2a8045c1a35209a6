// SPDX-License-Identifier: Apache-2.0
//
// The map for people as cloud-optimized GeoTIFF (raster_file.h).
#pragma once

#include <filesystem>

#include "formats/gdal_session.h"
#include "formats/map_codes.h"
#include "formats/map_writer.h"
#include "formats/provenance.h"
#include "formats/raster_digest.h"
#include "formats/raster_file.h"
#include "formats/scratch_raster.h"

namespace formats {

class CogMap : public MapWriter {
 public:
  CogMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
         const Provenance& provenance, const GdalSession& session);
  void Take(int first_row, const survey::SiteRaster& rows) override;
  void Finish() override;

 private:
  void TakeBand(int band, int first_row, std::vector<std::uint8_t> codes);

  bool has_sigma_;
  ScratchRaster scratch_;
  RasterDigest digest_;
};

}  // namespace formats
