// SPDX-License-Identifier: Apache-2.0
//
// A raster that need not be in memory: its frame, and its rows when asked for. Site maps are composed and written strip
// by strip, so that memory grows with a strip and not with the site's area.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "survey/grid/site_raster.h"

namespace survey {

struct RasterStrips {
  SiteRaster frame;        // cell size and extent; no cells
  bool has_sigma = false;  // the rows come with the positional uncertainty of their cells
  // Rows [min_row, min_row + height) of the site's cell grid over the whole width; within the frame.
  std::function<SiteRaster(std::int64_t min_row, int height)> read;
};

inline SiteRaster FrameOf(const SiteRaster& raster) {
  return {raster.cell_size_m, raster.min_column, raster.min_row, raster.width, raster.height, {}, {}, {}};
}

inline SiteRaster RowsOf(const SiteRaster& frame, std::int64_t min_row, int height) {
  SiteRaster rows = FrameOf(frame);
  rows.min_row = min_row;
  rows.height = height;
  return rows;
}

inline SiteRaster WholeOf(const RasterStrips& strips) { return strips.read(strips.frame.min_row, strips.frame.height); }

// Strips of a raster that is in memory and outlives them.
inline RasterStrips StripsOf(const SiteRaster& raster) {
  const auto read = [&raster](std::int64_t min_row, int height) {
    SiteRaster rows = RowsOf(raster, min_row, height);
    const auto width = static_cast<std::ptrdiff_t>(raster.width);
    const auto first = width * static_cast<std::ptrdiff_t>(min_row - raster.min_row);
    const auto copy = [&](const std::vector<float>& from, std::vector<float>* to) {
      if (!from.empty()) to->assign(from.begin() + first, from.begin() + first + width * height);
    };
    copy(raster.log_odds, &rows.log_odds);
    copy(raster.sigma_m, &rows.sigma_m);
    return rows;
  };
  return {FrameOf(raster), !raster.sigma_m.empty(), read};
}

}  // namespace survey
