// SPDX-License-Identifier: Apache-2.0
//
// A map of surfaces below the cell: each cell keeps the mean and the normal of the end points that fell into it, so
// that walls stand where the beams hit them on average and not on a raster. The map side of MatchToSurfaces. Frame: the
// caller's, metres. The cells lie in square tiles that copies of a map share until one of them draws there, so that the
// maps of many particles cost little more than one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "survey/geometry/pose2.h"

namespace survey {

// An end point of a scan with the normal of the surface that it lies on, pointing to the lidar; zero where the scan
// alone does not tell (edges, single points).
struct SurfacePoint {
  Eigen::Vector2f position;
  Eigen::Vector2f normal = Eigen::Vector2f::Zero();
  float weight =
      1.0F;  // of a point without normal: less where beams are far apart and the point may lie anywhere between
};

// Points of `hits` (in order along the scan, lidar at the origin) at least spacing_m apart, with normals from their
// neighbours along the scan. The spacing grows until at most max_points remain (0: no limit).
void SurfacePointsOfScan(std::span<const Eigen::Vector2f> hits, double spacing_m, std::size_t max_points,
                         std::vector<SurfacePoint>* points);

// A piece of surface: mean of its points and of their normals.
struct Surfel {
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  Eigen::Vector2f normal_sum = Eigen::Vector2f::Zero();
  Eigen::Vector2f normal = Eigen::Vector2f::Zero();  // unit; zero where the points had none
  float count = 0.0F;
  std::uint32_t next = 0;  // of its tile: another one in the same cell that faces another way; 0: none
};

// 32 x 32 cells. A cell holds the index of its first surfel, 0: none, and in which of the nine cells around its middle
// surfels lie.
struct SurfaceTile {
  static constexpr int kBits = 5;
  static constexpr int kCells = 1 << kBits;
  static constexpr std::uint32_t kIndex = 0xffff;
  static constexpr int kAround = 16;  // first of the nine bits, row by row from the south-west
  static std::size_t CellOf(int column, int row) {
    return static_cast<std::size_t>(((row & (kCells - 1)) << kBits) + (column & (kCells - 1)));
  }

  std::array<std::uint32_t, std::size_t{kCells} * kCells> cells{};
  std::vector<Surfel> surfels = std::vector<Surfel>(1);  // the one at 0 is not used
};

class SurfaceMap {
 public:
  explicit SurfaceMap(double cell_size_m);

  // Enters the points of a scan, given in the scan's frame.
  void Insert(const Pose2& map_from_scan, std::span<const SurfacePoint> points_in_scan);

  // The surfel nearest to a point of the map frame, in its cell and the eight around; of those that face the same way
  // where both normals are known. Null when there is none.
  const Surfel* Nearest(const Eigen::Vector2f& p, const Eigen::Vector2f& normal) const;

  // Whether a surface lies in the cell of the point or beside it: for searches.
  bool Near(float x, float y) const {
    const int column = static_cast<int>(std::floor(x * cells_per_m_));
    const int row = static_cast<int>(std::floor(y * cells_per_m_));
    const SurfaceTile* tile = TileAt(column, row);
    return tile != nullptr && tile->cells[SurfaceTile::CellOf(column, row)] >> SurfaceTile::kAround != 0;
  }

  double cell_size_m() const { return cell_size_m_; }

 private:
  // Null where nothing was drawn yet.
  const SurfaceTile* TileAt(int column, int row) const {
    const int x = (column >> SurfaceTile::kBits) - min_x_;
    const int y = (row >> SurfaceTile::kBits) - min_y_;
    const bool inside = static_cast<unsigned>(x) < static_cast<unsigned>(width_) &&
                        static_cast<unsigned>(y) < static_cast<unsigned>(height_);
    return inside ? tiles_[IndexOf(x, y)].get() : nullptr;
  }
  std::size_t IndexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  void GrowToHold(const Eigen::Vector2f& low, const Eigen::Vector2f& high);
  // The tile of a cell, made this map's own: copied if another map shares it.
  SurfaceTile& OwnTile(int column, int row);
  void Enter(const Eigen::Vector2f& p, const Eigen::Vector2f& normal);
  void TellAround(int column, int row);  // that a surfel lies here

  double cell_size_m_;
  float cells_per_m_;
  int min_x_ = 0;  // of the tiles
  int min_y_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::shared_ptr<SurfaceTile>> tiles_;
};

}  // namespace survey
