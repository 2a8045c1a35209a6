// SPDX-License-Identifier: Apache-2.0
#include "formats/cloud_tiles.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include "formats/cloud_file.h"
#include "formats/errors.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

using TileIndex = std::pair<std::int64_t, std::int64_t>;  // column, row

constexpr std::size_t kBuffered = 16384;    // points of a tile that wait in memory
constexpr std::size_t kMostTiles = 10'000;  // a square kilometre

// Removes what a run that was killed left behind, and what this one makes.
class ScratchTiles {
 public:
  explicit ScratchTiles(fs::path folder) : folder_(std::move(folder)) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ScratchTiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  ScratchTiles(const ScratchTiles&) = delete;
  ScratchTiles& operator=(const ScratchTiles&) = delete;

  fs::path FileOf(const TileIndex& tile) const {
    return folder_ / (std::to_string(tile.first) + "_" + std::to_string(tile.second));
  }

 private:
  fs::path folder_;
};

class Tiler {
 public:
  Tiler(const fs::path& cloud, const fs::path& scratch, const CloudTiling& tiling)
      : cloud_(cloud), tiling_(tiling), scratch_(scratch) {}

  void Sort() {
    ReadCloudPoints(cloud_, [&](const CloudPoint& point) { Add(point); });
    for (auto& [tile, points] : buffers_) Flush(tile, &points);
  }

  void Hand(const std::function<void(const CloudTile&)>& take) const {
    for (const auto& [index, unused] : buffers_) take(Read(index));
  }

 private:
  Eigen::Vector3d OriginOf(const TileIndex& tile) const {
    return {static_cast<double>(tile.first) * tiling_.tile_m, static_cast<double>(tile.second) * tiling_.tile_m, 0.0};
  }

  // To its own tile and to those within the margin.
  void Add(const CloudPoint& point) {
    const Eigen::Vector3d& p = point.position;
    const auto first = [&](double v) { return std::llround(std::floor((v - tiling_.margin_m) / tiling_.tile_m)); };
    const auto last = [&](double v) { return std::llround(std::floor((v + tiling_.margin_m) / tiling_.tile_m)); };
    for (std::int64_t column = first(p.x()); column <= last(p.x()); ++column) {
      for (std::int64_t row = first(p.y()); row <= last(p.y()); ++row) AddTo({column, row}, point);
    }
  }

  void AddTo(const TileIndex& tile, const CloudPoint& point) {
    std::vector<Eigen::Vector4f>& points = buffers_[tile];
    if (buffers_.size() > kMostTiles)
      throw DataError(cloud_.string() + ": is scattered over more than a square kilometre: are its units metres?");
    const Eigen::Vector3f p = (point.position - OriginOf(tile)).cast<float>();
    points.emplace_back(p.x(), p.y(), p.z(), point.intensity);
    if (points.size() >= kBuffered) Flush(tile, &points);
  }

  void Flush(const TileIndex& tile, std::vector<Eigen::Vector4f>* points) const {
    std::ofstream out(scratch_.FileOf(tile), std::ios::binary | std::ios::app);
    out.write(reinterpret_cast<const char*>(points->data()),
              static_cast<std::streamsize>(points->size() * sizeof(Eigen::Vector4f)));
    out.close();
    if (!out) throw DataError(scratch_.FileOf(tile).string() + ": cannot be written (is the disk full?)");
    *points = {};
  }

  CloudTile Read(const TileIndex& index) const {
    const fs::path file = scratch_.FileOf(index);
    std::vector<Eigen::Vector4f> records(fs::file_size(file) / sizeof(Eigen::Vector4f));
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(records.data()),
            static_cast<std::streamsize>(records.size() * sizeof(Eigen::Vector4f)));
    if (!in) throw DataError(file.string() + ": cannot be read");
    CloudTile tile{.origin = OriginOf(index), .size_m = tiling_.tile_m, .points = {}, .intensities = {}};
    for (const Eigen::Vector4f& record : records) {
      tile.points.emplace_back(record.head<3>());
      tile.intensities.push_back(record.w());
    }
    return tile;
  }

  const fs::path& cloud_;
  CloudTiling tiling_;
  ScratchTiles scratch_;
  std::map<TileIndex, std::vector<Eigen::Vector4f>> buffers_;
};

}  // namespace

void ForEachTile(const fs::path& file, const fs::path& scratch, const CloudTiling& tiling,
                 const std::function<void(const CloudTile&)>& take) {
  Tiler tiler(file, scratch, tiling);
  tiler.Sort();
  tiler.Hand(take);
}

}  // namespace formats
