// SPDX-License-Identifier: Apache-2.0
//
// A map on its way into a file: takes a raster row by row from the north, so that files of several forms are written
// from one pass over it.
#pragma once

#include <span>

#include "survey/grid/raster_strips.h"

namespace formats {

class MapWriter {
 public:
  virtual ~MapWriter() = default;

  // The next whole rows; `first_row` counts from the north.
  virtual void Take(int first_row, const survey::SiteRaster& rows) = 0;

  // After the last row: puts the file in its place.
  virtual void Finish() = 0;
};

// A strip of rows at a time: memory does not grow with the raster's height.
void WriteInOnePass(const survey::RasterStrips& strips, std::span<MapWriter* const> writers);

}  // namespace formats
