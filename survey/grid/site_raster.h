// SPDX-License-Identifier: Apache-2.0
//
// A north-up occupancy raster on the site's cell grid. Cell (column c, row r) covers
// [c s, (c+1) s) x [r s, (r+1) s) of the site frame (x east, y north), s = cell_size_m, so that rasters of all blocks
// align cell to cell. Row 0 of the array is the southernmost one; GeoTIFF writers flip.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace survey {

inline constexpr float kUnknownLogOdds = std::numeric_limits<float>::quiet_NaN();

inline float ProbabilityFromLogOdds(float log_odds) { return 1.0F / (1.0F + std::exp(-log_odds)); }

struct SiteRaster {
  double cell_size_m = 0.05;
  std::int64_t min_column = 0;  // site column of array column 0
  std::int64_t min_row = 0;     // site row of array row 0
  int width = 0;
  int height = 0;
  std::vector<float> log_odds;  // width * height, row by row from the south; NaN = never observed
  // Positional uncertainty of what a cell shows: 1 sigma in the worst direction, m, by the poses that drew it; NaN
  // where none did. Empty: not known.
  std::vector<float> sigma_m;
  // Index of the scan of the block that drew the cell; NaN where not known. Empty: not asked (no file holds it).
  std::vector<float> drawn_by;

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  float& At(int column, int row) { return log_odds[Index(column, row)]; }
  float At(int column, int row) const { return const_cast<SiteRaster*>(this)->At(column, row); }
  bool Contains(std::int64_t column, std::int64_t row) const {
    return column >= 0 && column < width && row >= 0 && row < height;
  }
  // Array column and row of the cell that holds a point (may lie outside the array).
  Eigen::Vector2<std::int64_t> CellOf(const Eigen::Vector2d& p_in_site) const {
    return {static_cast<std::int64_t>(std::floor(p_in_site.x() / cell_size_m)) - min_column,
            static_cast<std::int64_t>(std::floor(p_in_site.y() / cell_size_m)) - min_row};
  }
  Eigen::Vector2d CentreOf(int column, int row) const {
    return {(static_cast<double>(min_column + column) + 0.5) * cell_size_m,
            (static_cast<double>(min_row + row) + 0.5) * cell_size_m};
  }
};

// South-western and north-eastern corner, site frame (m).
inline Eigen::Vector2d LowCornerOf(const SiteRaster& raster) {
  return raster.cell_size_m *
         Eigen::Vector2d(static_cast<double>(raster.min_column), static_cast<double>(raster.min_row));
}
inline Eigen::Vector2d HighCornerOf(const SiteRaster& raster) {
  return LowCornerOf(raster) + raster.cell_size_m * Eigen::Vector2d(raster.width, raster.height);
}

}  // namespace survey
