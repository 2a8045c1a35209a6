// SPDX-License-Identifier: Apache-2.0
//
// The wall faces of an occupancy raster: how much of a wall each cell is, and to which side it is free.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

// The smoothing round a cell reaches so far: a face at the border of a part of a map is that of the whole map where the
// part goes on for so many cells.
inline constexpr int kFaceReachCells = 8;

// A vector per cell: its length is the smoothed wall content (0..1), its direction points into the free space in front
// of the face. Cells with free space on both sides alike have a short vector. Addressed by site column and row; zero
// outside.
class FaceImage {
 public:
  FaceImage(const SiteRaster& raster, double occupied_probability, double free_probability);

  Eigen::Vector2f At(std::int64_t site_column, std::int64_t site_row) const {
    const std::int64_t column = site_column - min_column_;
    const std::int64_t row = site_row - min_row_;
    if (column < 0 || column >= width_ || row < 0 || row >= height_) return Eigen::Vector2f::Zero();
    const auto i = static_cast<std::size_t>(row * width_ + column);
    return {x_[i], y_[i]};
  }

  // Of all cells, in the order of the raster.
  const std::vector<float>& x() const { return x_; }
  const std::vector<float>& y() const { return y_; }

 private:
  void AddFaces(const std::vector<float>& wall, const std::vector<float>& free);

  std::int64_t min_column_;
  std::int64_t min_row_;
  std::int64_t width_;
  std::int64_t height_;
  std::vector<float> x_;
  std::vector<float> y_;
};

}  // namespace survey
