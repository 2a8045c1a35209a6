// SPDX-License-Identifier: Apache-2.0
//
// A block's map as the square tiles of the site's cells in which it saw anything: what it takes in memory depends on
// what the block saw and not on its frame, and any part of it is at hand without reading its file again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "survey/grid/coverage.h"
#include "survey/grid/faces.h"
#include "survey/grid/raster_strips.h"
#include "survey/grid/seams.h"

namespace survey {

// A value per cell, kept by tiles; tiles of which every cell is `nothing` (a number, or NaN) take no room.
class TiledLayer {
 public:
  TiledLayer(const SiteRaster& frame, float nothing);

  // Takes the cells of `box` out of an array over `raster`'s frame; both lie in the frame, each cell is taken once.
  void Take(const CellBox& box, const SiteRaster& raster, const std::vector<float>& cells);

  // All cells of `part`'s frame, which lies in the frame.
  std::vector<float> Cells(const SiteRaster& part) const;

  bool AnyIn(const CellBox& box) const;  // whether a tile that meets the box is kept
  std::size_t bytes() const { return cells_.size() * sizeof(float) + place_.size() * sizeof(std::int32_t); }

 private:
  static constexpr std::int32_t kNotKept = -1;

  bool IsNothing(float value) const;
  std::size_t TileOf(std::int64_t column, std::int64_t row) const;  // that holds a site cell
  void TakeRun(std::int64_t column, std::int64_t row, const float* from, std::int64_t count);

  float nothing_;
  std::int64_t min_column_;  // of the tiles
  std::int64_t min_row_;
  std::int64_t width_;
  std::vector<std::int32_t> place_;  // by tile: which of the kept ones it is
  std::vector<float> cells_;         // of the kept tiles, row by row
};

class SeenTiles {
 public:
  explicit SeenTiles(const RasterStrips& map);

  // The part of the map that lies within `margin` cells of the box; log-odds only.
  SiteRaster Part(const CellBox& box, std::int64_t margin) const;
  bool SawAnythingIn(const CellBox& box) const { return log_odds_.AnyIn(box); }
  const SiteRaster& frame() const { return frame_; }
  std::size_t bytes() const { return log_odds_.bytes(); }

 private:
  SiteRaster frame_;
  TiledLayer log_odds_;
};

// With the faces of its walls, found once for all that the map is compared with.
class FacedTiles {
 public:
  FacedTiles(const RasterStrips& map, const SeamOptions& options);

  FacedRaster Part(const CellBox& box, std::int64_t margin) const;
  std::size_t bytes() const { return map_.bytes() + face_x_.bytes() + face_y_.bytes(); }

 private:
  void FindFaces(const CellBox& box, const SeamOptions& options);

  SeenTiles map_;
  TiledLayer face_x_;
  TiledLayer face_y_;
};

}  // namespace survey
