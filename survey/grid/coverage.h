// SPDX-License-Identifier: Apache-2.0
//
// How much of a map was seen, in square tiles of the site's cells: tells cheaply whether two maps know the same place,
// and where, so that only that part of them has to be read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "survey/grid/raster_strips.h"

namespace survey {

inline constexpr int kTileCells = 32;  // side of a tile: 1.6 m with cells of 5 cm

constexpr std::int64_t FloorDivide(std::int64_t value, std::int64_t by) {
  return value >= 0 ? value / by : -((-value + by - 1) / by);
}

// Some rows of a map after the others, each once.
template <typename Visit>
void VisitRows(const RasterStrips& map, const Visit& visit) {
  constexpr int kRowsAtATime = 512;
  for (int row = 0; row < map.frame.height; row += kRowsAtATime)
    visit(map.read(map.frame.min_row + row, std::min(kRowsAtATime, map.frame.height - row)));
}

// Site cells [min, end) in both directions.
struct CellBox {
  std::int64_t min_column = 0;
  std::int64_t min_row = 0;
  std::int64_t end_column = 0;
  std::int64_t end_row = 0;
};

// The smallest box that holds both.
inline CellBox Hull(const CellBox& a, const CellBox& b) {
  return {std::min(a.min_column, b.min_column), std::min(a.min_row, b.min_row), std::max(a.end_column, b.end_column),
          std::max(a.end_row, b.end_row)};
}

inline CellBox BoxOf(const SiteRaster& raster) {
  return {raster.min_column, raster.min_row, raster.min_column + raster.width, raster.min_row + raster.height};
}

// The frame of the part of a map that lies within `margin` cells of the box; without cells where there is none.
SiteRaster FrameWithin(const SiteRaster& frame, const CellBox& box, std::int64_t margin);

// What two maps may have seen both.
struct CommonCoverage {
  std::int64_t max_cells = 0;  // at most so many cells
  CellBox box;                 // within
};

class Coverage {
 public:
  explicit Coverage(const RasterStrips& map);

  CommonCoverage With(const Coverage& other) const;

 private:
  void Count(const SiteRaster& rows);
  int At(std::int64_t tile_column, std::int64_t tile_row) const;  // 0 outside

  std::int64_t min_column_ = 0;  // of the tiles
  std::int64_t min_row_ = 0;
  std::int64_t width_ = 0;
  std::int64_t height_ = 0;
  std::vector<std::uint16_t> known_;  // cells by tile
};

// The part of a map that lies within `margin` cells of the box.
SiteRaster PartOf(const RasterStrips& map, const CellBox& box, std::int64_t margin);

// The map with the occupancy of a part of it taken from there.
RasterStrips WithPart(const RasterStrips& map, SiteRaster part);

}  // namespace survey
