// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/faces.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace survey {
namespace {

void AddScaled(const float* from, std::ptrdiff_t count, float weight, float* to) {
  for (std::ptrdiff_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

// Separable filter with the given half kernel (centre first) along rows and columns; zero outside the image.
class Smoother {
 public:
  Smoother(int width, int height) : width_(width), height_(height) {}

  template <std::size_t N>
  std::vector<float> operator()(const std::vector<float>& image, const std::array<float, N>& half) const {
    return AlongColumns(AlongRows(image, half), half);
  }

 private:
  template <std::size_t N>
  std::vector<float> AlongRows(const std::vector<float>& image, const std::array<float, N>& half) const {
    std::vector<float> result(image.size(), 0.0F);
    for (std::ptrdiff_t row = 0; row < height_; ++row) {
      const float* from = image.data() + row * width_;
      float* to = result.data() + row * width_;
      AddScaled(from, width_, half[0], to);
      for (std::ptrdiff_t k = 1; k < std::min<std::ptrdiff_t>(N, width_); ++k) {
        AddScaled(from, width_ - k, half[static_cast<std::size_t>(k)], to + k);
        AddScaled(from + k, width_ - k, half[static_cast<std::size_t>(k)], to);
      }
    }
    return result;
  }

  template <std::size_t N>
  std::vector<float> AlongColumns(const std::vector<float>& image, const std::array<float, N>& half) const {
    std::vector<float> result(image.size(), 0.0F);
    for (std::ptrdiff_t row = 0; row < height_; ++row) {
      const float* from = image.data() + row * width_;
      float* to = result.data() + row * width_;
      AddScaled(from, width_, half[0], to);
      for (std::ptrdiff_t k = 1; k < static_cast<std::ptrdiff_t>(N); ++k) {
        const float weight = half[static_cast<std::size_t>(k)];
        if (row >= k) AddScaled(from - k * width_, width_, weight, to);
        if (row + k < height_) AddScaled(from + k * width_, width_, weight, to);
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

// Many cells hold what the one before them holds.
class ProbabilityOfCells {
 public:
  float operator()(float log_odds) {
    if (log_odds != last_) {
      last_ = log_odds;
      probability_ = ProbabilityFromLogOdds(log_odds);
    }
    return probability_;
  }

 private:
  float last_ = 0.0F;
  float probability_ = 0.5F;
};

}  // namespace

FaceImage::FaceImage(const SiteRaster& raster, double occupied_probability, double free_probability)
    : min_column_(raster.min_column),
      min_row_(raster.min_row),
      width_(raster.width),
      height_(raster.height),
      x_(raster.log_odds.size(), 0.0F),
      y_(raster.log_odds.size(), 0.0F) {
  std::vector<float> wall(raster.log_odds.size(), 0.0F);
  std::vector<float> free(raster.log_odds.size(), 0.0F);
  const float floor_probability = 0.5F;
  const float full = static_cast<float>(occupied_probability) - floor_probability;
  ProbabilityOfCells probability_of;
  for (std::size_t i = 0; i < raster.log_odds.size(); ++i) {
    if (std::isnan(raster.log_odds[i])) continue;
    const float probability = probability_of(raster.log_odds[i]);
    wall[i] = std::clamp((probability - floor_probability) / full, 0.0F, 1.0F);
    free[i] = probability <= static_cast<float>(free_probability) ? 1.0F : 0.0F;
  }
  const Smoother smooth(raster.width, raster.height);
  AddFaces(smooth(wall, HalfGaussian<4>(kWallSigmaCells)), smooth(free, HalfGaussian<6>(kFreeSigmaCells)));
}

void FaceImage::AddFaces(const std::vector<float>& wall, const std::vector<float>& free) {
  const auto stride = static_cast<std::size_t>(width_);
  for (std::int64_t row = 1; row + 1 < height_; ++row) {
    for (std::int64_t column = 1; column + 1 < width_; ++column) {
      const auto i = static_cast<std::size_t>(row * width_ + column);
      if (wall[i] < 0.02F) continue;
      const Eigen::Vector2f slope((free[i + 1] - free[i - 1]) / 2, (free[i + stride] - free[i - stride]) / 2);
      const float steepness = slope.norm();
      constexpr float kSteep = 0.1F;  // a straight edge of free space two cells away
      if (steepness <= 1e-6F) continue;
      const Eigen::Vector2f face = wall[i] * std::min(1.0F, steepness / kSteep) / steepness * slope;
      x_[i] = face.x();
      y_[i] = face.y();
    }
  }
}

}  // namespace survey
