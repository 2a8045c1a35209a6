// SPDX-License-Identifier: Apache-2.0
//
// Square pictures cut out of a raster of Plumbline (grid.tif, map.tif, site.tif) on demand, at its cell size and at
// halves of it, for maps that are looked at in a browser. Levels that the file has as overviews are read from disk;
// others are made once and kept (a third of a byte per cell together).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>

namespace formats {

class MapTiles {
 public:
  // White free, black occupied; or blue to red up to 0.1 m. Cells that are not known are transparent.
  enum class Picture { kOccupancy, kUncertainty };
  static constexpr int kTile = 256;  // cells along a side

  // DataError when the file is no map of Plumbline or has no such band.
  MapTiles(std::filesystem::path file, Picture picture);
  ~MapTiles();

  struct Frame {
    Eigen::Vector2d north_west = Eigen::Vector2d::Zero();  // corner in the site frame, m
    double cell_size_m = 0.0;
    int width = 0;  // cells
    int height = 0;
    int num_levels = 0;  // the last one fits into a tile
    bool tied = false;   // to control
    std::string crs;
  };
  const Frame& frame() const;

  // PNG of the tile `column` from the west and `row` from the north in a level (0: the cells themselves, each next one
  // half as fine). Empty when there is no such tile. May be called by several threads.
  std::string Tile(int level, int column, int row);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Whether a raster tells the positional uncertainty of its cells.
bool HasUncertainty(const std::filesystem::path& file);

}  // namespace formats
