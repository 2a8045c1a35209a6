// SPDX-License-Identifier: Apache-2.0
//
// A block's map as the square tiles of the site's cells in which it saw anything: what it takes in memory depends on
// what the block saw and not on its frame, and any part of it is at hand without reading its file again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "survey/grid/coverage.h"
#include "survey/grid/raster_strips.h"

namespace survey {

class SeenTiles {
 public:
  explicit SeenTiles(const RasterStrips& map);

  // The part of the map that lies within `margin` cells of the box; log-odds only.
  SiteRaster Part(const CellBox& box, std::int64_t margin) const;
  std::size_t bytes() const { return cells_.size() * sizeof(float) + place_.size() * sizeof(std::int32_t); }

 private:
  static constexpr std::int32_t kNothingSeen = -1;

  void TakeRows(const SiteRaster& rows);
  std::size_t TileOf(std::int64_t column, std::int64_t row) const;  // that holds a site cell
  void CopyRow(std::int64_t row, SiteRaster* part) const;

  SiteRaster frame_;
  std::int64_t min_column_ = 0;  // of the tiles
  std::int64_t min_row_ = 0;
  std::int64_t width_ = 0;
  std::vector<std::int32_t> place_;  // by tile: which of the kept ones it is
  std::vector<float> cells_;         // of the kept tiles, row by row
};

}  // namespace survey
