// SPDX-License-Identifier: Apache-2.0
//
// A byte raster of any size on disk beside the deliverable that is made of it: filled strip by strip, then copied by
// GDAL's drivers that can only copy (COG, PNG). Removed at the end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "formats/atomic_file.h"
#include "formats/gdal_session.h"
#include "survey/grid/site_raster.h"

class GDALDataset;
class GDALRasterBand;

namespace formats {

class ScratchRaster {
 public:
  // The copy to `target` is made inside `session`.
  ScratchRaster(const std::filesystem::path& target, const survey::SiteRaster& frame, int num_bands,
                const GdalSession& session);

  // Writes rows from the north; `rows` holds whole rows. Bands count from 1.
  void Write(int band, int first_row, std::span<std::uint8_t> rows);

  // Overviews of all bands down to `smallest` cells, in which a cell takes the largest value below it other than
  // `unknown`.
  void BuildOverviews(int smallest, std::uint8_t unknown);

  // Copies to the target by a driver of GDAL and puts it in place.
  void CopyTo(const char* driver, char** options);

  GDALDataset* data() { return data_.get(); }

 private:
  struct Close {
    void operator()(GDALDataset* data) const;
  };
  void HalveInto(GDALRasterBand* fine, GDALRasterBand* coarse, std::uint8_t unknown);
  void Check(bool good) const;

  std::filesystem::path target_;
  const GdalSession& session_;
  AtomicFile file_;
  std::unique_ptr<GDALDataset, Close> data_;
};

}  // namespace formats
