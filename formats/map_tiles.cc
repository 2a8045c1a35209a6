// SPDX-License-Identifier: Apache-2.0
#include "formats/map_tiles.h"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/map_codes.h"
#include "formats/raster_description.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using Codes = std::vector<std::uint8_t>;
using Colour = cv::Vec4b;  // blue, green, red, opacity
using Palette = std::array<Colour, 256>;

struct Window {
  int column = 0;
  int row = 0;  // from the north
  int width = 0;
  int height = 0;
};

GDALDatasetUniquePtr OpenMap(const fs::path& file, const GdalSession& session) {
  const char* const drivers[] = {"GTiff", nullptr};
  GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  if (data->GetMetadataItem(kContentItem) == nullptr) throw DataError(file.string() + ": is not a map of Plumbline");
  return data;
}

int BandOf(GDALDataset* data, MapTiles::Picture picture) {
  if (picture == MapTiles::Picture::kOccupancy) return 1;
  for (int band = 2; band <= data->GetRasterCount(); ++band) {
    if (data->GetRasterBand(band)->GetDescription() == std::string_view(kSigmaName)) return band;
  }
  return 0;
}

Palette OccupancyPalette() {
  Palette palette;
  for (int percent = 0; percent <= 100; ++percent) {
    const double blackness = std::clamp((percent - 20) / 45.0, 0.0, 1.0);  // the thresholds of ROS map_server
    const auto grey = static_cast<std::uint8_t>(255.0 * (1.0 - blackness));
    palette[static_cast<std::size_t>(percent)] = Colour(grey, grey, grey, 255);
  }
  return palette;
}

// From blue over yellow to red.
Palette UncertaintyPalette() {
  constexpr double kRed_m = 0.1;
  Palette palette;
  for (int step = 0; step < 255; ++step) {
    const double share = std::min(1.0, step * kSigmaStep_m / kRed_m);
    const double rising = std::min(1.0, 2.0 * share);
    const double falling = std::min(1.0, 2.0 - 2.0 * share);
    const auto byte = [](double value) { return static_cast<std::uint8_t>(255.0 * value); };
    palette[static_cast<std::size_t>(step)] =
        Colour(byte(1.0 - rising), byte(0.85 * rising * falling), byte(rising), 150);
  }
  return palette;
}

MapTiles::Frame FrameOf(const fs::path& file, GDALDataset* data) {
  std::array<double, 6> transform{};
  if (data->GetGeoTransform(transform.data()) != CE_None) throw DataError(file.string() + ": has no georeference");
  const auto item = [&](const char* name) {
    const char* value = data->GetMetadataItem(name);
    return std::string(value == nullptr ? "" : value);
  };
  MapTiles::Frame frame{.north_west = {transform[0], transform[3]},
                        .cell_size_m = transform[1],
                        .width = data->GetRasterXSize(),
                        .height = data->GetRasterYSize(),
                        .num_levels = 1,
                        .tied = item(kTiedItem) == "yes",
                        .crs = item(kCrsItem)};
  for (int size = std::max(frame.width, frame.height); size > MapTiles::kTile; size = (size + 1) / 2)
    ++frame.num_levels;
  return frame;
}

}  // namespace

struct MapTiles::Impl {
  fs::path file;
  Frame frame;
  Palette palette;
  std::uint8_t (*code)(float) = nullptr;  // of a cell that is not a code already
  GDALDatasetUniquePtr data;
  GDALRasterBand* band = nullptr;
  std::vector<Codes> levels;  // those that are not on disk; empty while not needed
  std::mutex mutex;           // GDAL reads a file by one thread at a time

  int Width(int level) const { return (frame.width + (1 << level) - 1) >> level; }
  int Height(int level) const { return (frame.height + (1 << level) - 1) >> level; }
  bool IsOnDisk(int level) const { return level <= band->GetOverviewCount(); }

  Codes ReadFromDisk(int level, const Window& window) {
    GDALRasterBand* source = level == 0 ? band : band->GetOverview(level - 1);
    const GdalSession session;
    const std::size_t size = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
    const auto read = [&](void* cells, GDALDataType type) {
      if (source->RasterIO(GF_Read, window.column, window.row, window.width, window.height, cells, window.width,
                           window.height, type, 0, 0, nullptr) != CE_None)
        session.Throw(file, "cannot be read");
    };
    Codes codes(size);
    if (code == nullptr) {
      read(codes.data(), GDT_Byte);
      return codes;
    }
    std::vector<float> cells(size);
    read(cells.data(), GDT_Float32);
    std::transform(cells.begin(), cells.end(), codes.begin(), code);
    return codes;
  }

  Codes Read(int level, const Window& window) {
    if (IsOnDisk(level)) return ReadFromDisk(level, window);
    const Codes& all = MadeLevel(level);
    Codes codes;
    for (int row = window.row; row < window.row + window.height; ++row) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(row) * Width(level) + window.column;
      codes.insert(codes.end(), begin, begin + window.width);
    }
    return codes;
  }

  const Codes& MadeLevel(int level) {
    Codes& made = levels[static_cast<std::size_t>(level)];
    if (made.empty()) {
      for (int row = 0; row < Height(level - 1); row += 2 * kTile) AddHalved(level, row, &made);
    }
    return made;
  }

  void AddHalved(int level, int first_row, Codes* made) {
    const int height = std::min(2 * kTile, Height(level - 1) - first_row);
    const Codes fine = Read(level - 1, {0, first_row, Width(level - 1), height});
    const Codes halved = Halved(fine, Width(level - 1), kUnknownCode);
    made->insert(made->end(), halved.begin(), halved.end());
  }
};

MapTiles::MapTiles(fs::path file, Picture picture) : impl_(std::make_unique<Impl>()) {
  const GdalSession session;
  impl_->file = std::move(file);
  impl_->data = OpenMap(impl_->file, session);
  const int band = BandOf(impl_->data.get(), picture);
  if (band == 0) throw DataError(impl_->file.string() + ": does not tell its uncertainty");
  impl_->band = impl_->data->GetRasterBand(band);
  impl_->frame = FrameOf(impl_->file, impl_->data.get());
  impl_->levels.resize(static_cast<std::size_t>(impl_->frame.num_levels));
  const bool occupancy = picture == Picture::kOccupancy;
  impl_->palette = occupancy ? OccupancyPalette() : UncertaintyPalette();
  if (impl_->band->GetRasterDataType() != GDT_Byte) impl_->code = occupancy ? &PercentOf : &SigmaStepsOf;
}

MapTiles::~MapTiles() = default;

const MapTiles::Frame& MapTiles::frame() const { return impl_->frame; }

std::string MapTiles::Tile(int level, int column, int row) {
  if (level < 0 || level >= impl_->frame.num_levels || column < 0 || row < 0) return "";
  const int columns = (impl_->Width(level) + kTile - 1) / kTile;
  const int rows = (impl_->Height(level) + kTile - 1) / kTile;
  if (column >= columns || row >= rows) return "";
  const Window window{column * kTile, row * kTile, std::min(kTile, impl_->Width(level) - column * kTile),
                      std::min(kTile, impl_->Height(level) - row * kTile)};
  Codes codes;
  {
    const std::lock_guard lock(impl_->mutex);
    codes = impl_->Read(level, window);
  }
  cv::Mat_<Colour> picture(kTile, kTile, Colour(0, 0, 0, 0));
  for (int r = 0; r < window.height; ++r) {
    const std::uint8_t* from = codes.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(window.width);
    for (int c = 0; c < window.width; ++c) picture(r, c) = impl_->palette[from[c]];
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 1});
  return {png.begin(), png.end()};
}

bool HasUncertainty(const fs::path& file) {
  const GdalSession session;
  return BandOf(OpenMap(file, session).get(), MapTiles::Picture::kUncertainty) != 0;
}

}  // namespace formats
