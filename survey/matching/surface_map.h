// SPDX-License-Identifier: Apache-2.0
//
// A map of surfaces below the cell: each cell keeps the mean and the normal of the end points that fell into it, so
// that walls stand where the beams hit them on average and not on a raster. The map side of MatchToSurfaces. Frame: the
// caller's, metres.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
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
  std::uint32_t next = 0;  // another one in the same cell that faces another way; 0: none
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
    const int column = static_cast<int>(std::floor(x * cells_per_m_)) - min_column_;
    const int row = static_cast<int>(std::floor(y * cells_per_m_)) - min_row_;
    return Inside(column, row) && near_[IndexOf(column, row)] != 0;
  }

  double cell_size_m() const { return cell_size_m_; }

 private:
  bool Inside(int column, int row) const {
    return static_cast<unsigned>(column) < static_cast<unsigned>(width_) &&
           static_cast<unsigned>(row) < static_cast<unsigned>(height_);
  }
  std::size_t IndexOf(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
  }
  void GrowToHold(const Eigen::Vector2f& low, const Eigen::Vector2f& high);
  void Enter(const Eigen::Vector2f& p, const Eigen::Vector2f& normal);

  double cell_size_m_;
  float cells_per_m_;
  int min_column_ = 0;
  int min_row_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint32_t> first_;  // by cell: its first surfel, 0: none
  std::vector<std::uint8_t> near_;    // by cell: a surfel here or beside
  std::vector<Surfel> surfels_;       // the one at 0 is not used
  std::vector<SurfacePoint> moved_;   // of the scan at hand, in the map's frame
};

}  // namespace survey
