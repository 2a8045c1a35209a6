// SPDX-License-Identifier: Apache-2.0
//
// The wall faces of an occupancy raster: how much of a wall each cell is, and to which side it is free.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

// A vector per cell: its length is the smoothed wall content (0..1), its direction points into the free space in front
// of the face. Cells with free space on both sides alike have a short vector. Addressed by site column and row; zero
// outside.
class FaceImage {
 public:
  FaceImage(const SiteRaster& raster, double occupied_probability, double free_probability, int near_cells);

  Eigen::Vector2f At(std::int64_t site_column, std::int64_t site_row) const {
    const std::int64_t column = site_column - min_column_;
    const std::int64_t row = site_row - min_row_;
    if (column < 0 || column >= width_ || row < 0 || row >= height_) return Eigen::Vector2f::Zero();
    return faces_[static_cast<std::size_t>(row * width_ + column)];
  }

  // True when some cell within `near_cells` columns and rows was observed.
  bool KnownNear(std::int64_t site_column, std::int64_t site_row) const;

 private:
  std::int64_t min_column_;
  std::int64_t min_row_;
  std::int64_t width_;
  std::int64_t height_;
  std::vector<Eigen::Vector2f> faces_;
  int near_cells_;
  std::vector<std::int32_t> known_before_;  // observed cells south-west of each cell corner, (width + 1) x (height + 1)
};

}  // namespace survey
