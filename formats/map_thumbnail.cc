// SPDX-License-Identifier: Apache-2.0
#include "formats/map_thumbnail.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "formats/gdal_session.h"

namespace formats {
namespace {

constexpr std::uint8_t kUnknown = 255;
constexpr std::uint8_t kUnknownGrey = 236;

// White is free, dark is occupied; anything less than clearly occupied stays light, so that lines drawn over the map
// can be read.
std::uint8_t Grey(std::uint8_t percent) {
  if (percent == kUnknown) return kUnknownGrey;
  if (percent <= 50) return 255;
  return static_cast<std::uint8_t>(255 - (percent - 50) * 4);
}

}  // namespace

MapThumbnail ReadMapThumbnail(const std::filesystem::path& file, int max_pixels) {
  const GdalSession session;
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  double transform[6];
  if (!data || data->GetRasterCount() > 2 || data->GetRasterBand(1)->GetRasterDataType() != GDT_Byte ||
      data->GetGeoTransform(transform) != CE_None) {
    session.Throw(file, "is not a georeferenced map with occupancy in percent");
  }
  const int width = data->GetRasterXSize();
  const int height = data->GetRasterYSize();
  const int factor = (std::max(width, height) + max_pixels - 1) / max_pixels;
  // The most occupied cell of each square is what shows, so that thin walls survive.
  cv::Mat picture((height + factor - 1) / factor, (width + factor - 1) / factor, CV_8UC1, cv::Scalar(kUnknownGrey));
  std::vector<std::uint8_t> line(static_cast<std::size_t>(width));
  std::vector<int> most(static_cast<std::size_t>(picture.cols));
  for (int row = 0; row < height; ++row) {
    if (row % factor == 0) std::fill(most.begin(), most.end(), -1);
    if (data->GetRasterBand(1)->RasterIO(GF_Read, 0, row, width, 1, line.data(), width, 1, GDT_Byte, 0, 0, nullptr) !=
        CE_None) {
      session.Throw(file, "cannot be read to its end");
    }
    for (int column = 0; column < width; ++column) {
      const std::uint8_t percent = line[static_cast<std::size_t>(column)];
      int& cell = most[static_cast<std::size_t>(column / factor)];
      if (percent != kUnknown) cell = std::max<int>(cell, percent);
    }
    for (int column = 0; column < picture.cols; ++column) {
      const int percent = most[static_cast<std::size_t>(column)];
      picture.at<std::uint8_t>(row / factor, column) =
          percent < 0 ? kUnknownGrey : Grey(static_cast<std::uint8_t>(percent));
    }
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  // The last row and column of squares may reach beyond the raster.
  const Eigen::Vector2d extent(picture.cols * factor * transform[1], picture.rows * factor * -transform[5]);
  return {.png = std::string(png.begin(), png.end()),
          .south_west = {transform[0], transform[3] - extent.y()},
          .extent_m = extent};
}

}  // namespace formats
