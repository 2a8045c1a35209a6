// SPDX-License-Identifier: Apache-2.0
#include "formats/map_thumbnail.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "formats/gdal_session.h"

namespace formats {
namespace {

constexpr std::uint8_t kUnknown = 255;
constexpr std::uint8_t kPaperGrey = 236;

// White is free, dark is occupied; anything less than clearly occupied stays light, so that lines drawn over the map
// can be read.
std::uint8_t Grey(std::uint8_t percent) {
  if (percent == kUnknown) return kPaperGrey;
  if (percent <= 50) return 255;
  return static_cast<std::uint8_t>(255 - (percent - 50) * 4);
}

// A delivered map, open for reading.
class DeliveredMap {
 public:
  explicit DeliveredMap(const std::filesystem::path& file)
      : file_(file),
        data_(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr)) {
    if (!data_ || data_->GetRasterCount() > 2 || data_->GetRasterBand(1)->GetRasterDataType() != GDT_Byte ||
        data_->GetGeoTransform(transform_) != CE_None) {
      session_.Throw(file, "is not a georeferenced map with occupancy in percent");
    }
  }

  int width() const { return data_->GetRasterXSize(); }
  int height() const { return data_->GetRasterYSize(); }
  double cell_m() const { return transform_[1]; }
  Eigen::Vector2d north_west() const { return {transform_[0], transform_[3]}; }

  // A rectangle of cells within the map, rows of `line_width` cells.
  void Read(int column, int row, int columns, int rows, std::uint8_t* cells, int line_width) const {
    if (data_->GetRasterBand(1)->RasterIO(GF_Read, column, row, columns, rows, cells, columns, rows, GDT_Byte, 1,
                                          line_width, nullptr) != CE_None)
      session_.Throw(file_, "cannot be read to its end");
  }

 private:
  std::filesystem::path file_;
  GdalSession session_;
  GDALDatasetUniquePtr data_;
  double transform_[6] = {};
};

MapThumbnail Thumbnail(const DeliveredMap& map, const cv::Mat& picture, int column, int row, int factor) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  const double pixel = factor * map.cell_m();
  // The last row and column of squares may reach beyond the raster.
  const Eigen::Vector2d extent(picture.cols * pixel, picture.rows * pixel);
  const Eigen::Vector2d corner = map.north_west() + map.cell_m() * Eigen::Vector2d(column, -row);
  return {.png = std::string(png.begin(), png.end()),
          .south_west = corner - Eigen::Vector2d(0.0, extent.y()),
          .extent_m = extent};
}

}  // namespace

MapThumbnail ReadMapThumbnail(const std::filesystem::path& file, int max_pixels) {
  const DeliveredMap map(file);
  const int width = map.width();
  const int height = map.height();
  const int factor = (std::max(width, height) + max_pixels - 1) / max_pixels;
  // The most occupied cell of each square is what shows, so that thin walls survive.
  cv::Mat picture((height + factor - 1) / factor, (width + factor - 1) / factor, CV_8UC1, cv::Scalar(kPaperGrey));
  std::vector<std::uint8_t> line(static_cast<std::size_t>(width));
  std::vector<int> most(static_cast<std::size_t>(picture.cols));
  for (int row = 0; row < height; ++row) {
    if (row % factor == 0) std::fill(most.begin(), most.end(), -1);
    map.Read(0, row, width, 1, line.data(), width);
    for (int column = 0; column < width; ++column) {
      const std::uint8_t percent = line[static_cast<std::size_t>(column)];
      int& cell = most[static_cast<std::size_t>(column / factor)];
      if (percent != kUnknown) cell = std::max<int>(cell, percent);
    }
    for (int column = 0; column < picture.cols; ++column) {
      const int percent = most[static_cast<std::size_t>(column)];
      picture.at<std::uint8_t>(row / factor, column) =
          percent < 0 ? kPaperGrey : Grey(static_cast<std::uint8_t>(percent));
    }
  }
  return Thumbnail(map, picture, 0, 0, factor);
}

std::vector<MapThumbnail> ReadMapWindows(const std::filesystem::path& file,
                                         const std::vector<Eigen::Vector2d>& centres_in_site, double half_width_m) {
  const DeliveredMap map(file);
  const int half = static_cast<int>(std::ceil(half_width_m / map.cell_m()));
  std::vector<MapThumbnail> windows;
  for (const Eigen::Vector2d& centre : centres_in_site) {
    const Eigen::Vector2d from_corner = (centre - map.north_west()) / map.cell_m();
    const int column = static_cast<int>(std::floor(from_corner.x())) - half;
    const int row = static_cast<int>(std::floor(-from_corner.y())) - half;
    cv::Mat picture(2 * half + 1, 2 * half + 1, CV_8UC1, cv::Scalar(kUnknown));
    const cv::Rect seen = cv::Rect(column, row, picture.cols, picture.rows) & cv::Rect(0, 0, map.width(), map.height());
    if (!seen.empty())
      map.Read(seen.x, seen.y, seen.width, seen.height, picture.ptr<std::uint8_t>(seen.y - row, seen.x - column),
               picture.cols);
    picture.forEach<std::uint8_t>([](std::uint8_t& cell, const int*) { cell = Grey(cell); });
    windows.push_back(Thumbnail(map, picture, column, row, 1));
  }
  return windows;
}

}  // namespace formats
