// SPDX-License-Identifier: Apache-2.0
//
// The map as a picture with a world file and its CRS (raster_file.h).
#pragma once

#include <filesystem>

#include "formats/gdal_session.h"
#include "formats/map_writer.h"
#include "formats/raster_file.h"
#include "formats/scratch_raster.h"

namespace formats {

class PngMap : public MapWriter {
 public:
  PngMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
         const GdalSession& session);
  void Take(int first_row, const survey::SiteRaster& rows) override;
  void Finish() override;

 private:
  std::filesystem::path file_;
  survey::SiteRaster frame_;
  RasterLabel label_;
  ScratchRaster scratch_;
};

}  // namespace formats
