// SPDX-License-Identifier: Apache-2.0
//
// Clouds larger than memory: read once and sorted into square tiles on disk, then handed over tile by tile. A tile also
// holds the points around it, so that what stands on an edge is whole in one of both.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <vector>

namespace formats {

struct CloudTiling {
  double tile_m = 10.0;
  double margin_m = 0.3;  // of the points around a tile
};

struct CloudTile {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // lower left corner, frame of the cloud
  double size_m = 0.0;
  std::vector<Eigen::Vector3f> points;  // from the origin: coordinates of a projection keep their digits
  std::vector<float> intensities;       // of the points; NaN where not known

  // Whether a place, from the origin, belongs to this tile and not to a neighbour.
  bool Holds(const Eigen::Vector3d& p) const {
    return p.x() >= 0.0 && p.x() < size_m && p.y() >= 0.0 && p.y() < size_m;
  }
};

// In order of columns and rows, whatever the order of the points. The tiles lie in the folder `scratch`, which is made
// and removed again. DataError as ReadCloud; where the disk is full or the cloud is scattered over too many tiles.
void ForEachTile(const std::filesystem::path& file, const std::filesystem::path& scratch, const CloudTiling& tiling,
                 const std::function<void(const CloudTile&)>& take);

}  // namespace formats
