// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/faces.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace survey {
namespace {

// Separable filter with the given half kernel (centre first) along columns (step 1) and rows (step width).
class Smoother {
 public:
  Smoother(int width, int height) : width_(width), height_(height) {}

  template <std::size_t N>
  std::vector<float> operator()(const std::vector<float>& image, const std::array<float, N>& half) const {
    return Along(Along(image, half, true), half, false);
  }

 private:
  template <std::size_t N>
  std::vector<float> Along(const std::vector<float>& image, const std::array<float, N>& half, bool columns) const {
    std::vector<float> result(image.size(), 0.0F);
    const int length = columns ? width_ : height_;
    const std::ptrdiff_t step = columns ? 1 : width_;
    for (int row = 0; row < height_; ++row) {
      for (int column = 0; column < width_; ++column) {
        const std::ptrdiff_t centre = static_cast<std::ptrdiff_t>(row) * width_ + column;
        const int place = columns ? column : row;
        float sum = half[0] * image[static_cast<std::size_t>(centre)];
        for (int k = 1; k < static_cast<int>(N); ++k) {
          const float weight = half[static_cast<std::size_t>(k)];
          if (place - k >= 0) sum += weight * image[static_cast<std::size_t>(centre - k * step)];
          if (place + k < length) sum += weight * image[static_cast<std::size_t>(centre + k * step)];
        }
        result[static_cast<std::size_t>(centre)] = sum;
      }
    }
    return result;
  }

  int width_;
  int height_;
};

// Gaussian weights, normalised, from the centre outwards.
template <std::size_t N>
std::array<float, N> HalfGaussian(double sigma_cells) {
  std::array<double, N> raw{};
  double sum = 0.0;
  for (std::size_t k = 0; k < N; ++k) {
    raw[k] = std::exp(-0.5 * static_cast<double>(k * k) / (sigma_cells * sigma_cells));
    sum += (k == 0 ? 1 : 2) * raw[k];
  }
  std::array<float, N> half{};
  for (std::size_t k = 0; k < N; ++k) half[k] = static_cast<float>(raw[k] / sum);
  return half;
}

constexpr double kWallSigmaCells = 1.0;
constexpr double kFreeSigmaCells = 1.5;

// Number of observed cells south-west of each cell corner.
std::vector<std::int32_t> CountKnown(const SiteRaster& raster) {
  const auto stride = static_cast<std::size_t>(raster.width) + 1;
  std::vector<std::int32_t> count(stride * (static_cast<std::size_t>(raster.height) + 1), 0);
  for (int row = 0; row < raster.height; ++row) {
    std::int32_t in_row = 0;
    for (int column = 0; column < raster.width; ++column) {
      in_row += std::isnan(raster.At(column, row)) ? 0 : 1;
      const std::size_t corner = (static_cast<std::size_t>(row) + 1) * stride + static_cast<std::size_t>(column) + 1;
      count[corner] = count[corner - stride] + in_row;
    }
  }
  return count;
}

}  // namespace

FaceImage::FaceImage(const SiteRaster& raster, double occupied_probability, double free_probability, int near_cells)
    : min_column_(raster.min_column),
      min_row_(raster.min_row),
      width_(raster.width),
      height_(raster.height),
      faces_(raster.log_odds.size(), Eigen::Vector2f::Zero()),
      near_cells_(near_cells),
      known_before_(CountKnown(raster)) {
  std::vector<float> wall(raster.log_odds.size(), 0.0F);
  std::vector<float> free(raster.log_odds.size(), 0.0F);
  const float floor_probability = 0.5F;
  const float full = static_cast<float>(occupied_probability) - floor_probability;
  for (std::size_t i = 0; i < raster.log_odds.size(); ++i) {
    if (std::isnan(raster.log_odds[i])) continue;
    const float probability = ProbabilityFromLogOdds(raster.log_odds[i]);
    wall[i] = std::clamp((probability - floor_probability) / full, 0.0F, 1.0F);
    free[i] = probability <= static_cast<float>(free_probability) ? 1.0F : 0.0F;
  }
  const Smoother smooth(raster.width, raster.height);
  wall = smooth(wall, HalfGaussian<4>(kWallSigmaCells));
  free = smooth(free, HalfGaussian<6>(kFreeSigmaCells));
  for (int row = 1; row + 1 < raster.height; ++row) {
    for (int column = 1; column + 1 < raster.width; ++column) {
      const std::size_t i =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(column);
      if (wall[i] < 0.02F) continue;
      const Eigen::Vector2f slope(
          (free[i + 1] - free[i - 1]) / 2,
          (free[i + static_cast<std::size_t>(raster.width)] - free[i - static_cast<std::size_t>(raster.width)]) / 2);
      const float steepness = slope.norm();
      constexpr float kSteep = 0.1F;  // a straight edge of free space two cells away
      if (steepness > 1e-6F) faces_[i] = wall[i] * std::min(1.0F, steepness / kSteep) / steepness * slope;
    }
  }
}

bool FaceImage::KnownNear(std::int64_t site_column, std::int64_t site_row) const {
  const auto corner = [this](std::int64_t column, std::int64_t row) {
    const std::int64_t c = std::clamp<std::int64_t>(column, 0, width_);
    const std::int64_t r = std::clamp<std::int64_t>(row, 0, height_);
    return known_before_[static_cast<std::size_t>(r * (width_ + 1) + c)];
  };
  const std::int64_t west = site_column - min_column_ - near_cells_;
  const std::int64_t south = site_row - min_row_ - near_cells_;
  const std::int64_t east = west + 2 * near_cells_ + 1;
  const std::int64_t north = south + 2 * near_cells_ + 1;
  return corner(east, north) - corner(west, north) - corner(east, south) + corner(west, south) > 0;
}

}  // namespace survey
