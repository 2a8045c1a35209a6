// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/map_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "survey/geometry/principal_axes.h"

namespace survey {
namespace {

constexpr double kTile_m = 0.5;  // sigmas change little within

struct UncertainPose {
  Eigen::Vector2d position;
  Eigen::Matrix3d covariance;
};

std::vector<UncertainPose> PosesOf(const Solution& solution) {
  std::vector<UncertainPose> poses;
  for (const NodeCovariance& node : solution.covariances) {
    const auto scan = static_cast<std::size_t>(node.scan.value);
    poses.push_back({solution.scans[scan].site_from_scan.Translation(), node.covariance});
  }
  return poses;
}

// Of a place that hangs on a pose.
Eigen::Matrix2d CovarianceAt(const Eigen::Vector2d& place, const UncertainPose& pose) {
  const Eigen::Vector2d lever = place - pose.position;
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1, 0, -lever.y(), 0, 1, lever.x();
  return by_pose * pose.covariance * by_pose.transpose();
}

const UncertainPose& Nearest(const Eigen::Vector2d& place, const std::vector<UncertainPose>& poses) {
  return *std::min_element(poses.begin(), poses.end(), [&](const UncertainPose& a, const UncertainPose& b) {
    return (a.position - place).squaredNorm() < (b.position - place).squaredNorm();
  });
}

float SigmaAt(const Eigen::Vector2d& place, const std::vector<UncertainPose>& poses) {
  const Eigen::Matrix2d covariance = CovarianceAt(place, Nearest(place, poses));
  return static_cast<float>(std::sqrt(std::max(0.0, PrincipalAxesOf(covariance).values[1])));
}

// Sigmas of a map by square tiles, which count from its south-western corner.
class SigmaTiles {
 public:
  SigmaTiles(const RasterStrips& map, const std::vector<UncertainPose>& poses)
      : frame_(map.frame),
        cells_(std::max(1, static_cast<int>(kTile_m / frame_.cell_size_m))),
        columns_((frame_.width + cells_ - 1) / cells_) {
    for (int first = 0; first < frame_.height; first += cells_) {
      const SiteRaster rows = map.read(frame_.min_row + first, std::min(cells_, frame_.height - first));
      for (int column = 0; column < frame_.width; column += cells_) AddTile(rows, column, poses);
    }
  }

  void Fill(SiteRaster* rows) const {
    rows->sigma_m.assign(rows->log_odds.size(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < rows->height; ++row) {
      const auto tile_row = static_cast<int>(rows->min_row + row - frame_.min_row) / cells_;
      const float* tiles = &sigma_m_[static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(columns_)];
      for (int column = 0; column < rows->width; ++column) {
        if (!std::isnan(rows->At(column, row))) rows->sigma_m[rows->Index(column, row)] = tiles[column / cells_];
      }
    }
  }

 private:
  // `rows` are those of the tile.
  void AddTile(const SiteRaster& rows, int first_column, const std::vector<UncertainPose>& poses) {
    const int end_column = std::min(rows.width, first_column + cells_);
    bool known = false;
    for (int row = 0; row < rows.height && !known; ++row) {
      for (int column = first_column; column < end_column && !known; ++column)
        known = !std::isnan(rows.At(column, row));
    }
    const Eigen::Vector2d centre =
        (rows.CentreOf(first_column, 0) + rows.CentreOf(end_column - 1, rows.height - 1)) / 2.0;
    sigma_m_.push_back(known ? SigmaAt(centre, poses) : std::numeric_limits<float>::quiet_NaN());
  }

  SiteRaster frame_;
  int cells_;    // along the side of a tile
  int columns_;  // of tiles
  std::vector<float> sigma_m_;
};

}  // namespace

std::optional<Eigen::Matrix2d> MapCovarianceAt(const Eigen::Vector2d& place, const Solution& solution) {
  const std::vector<UncertainPose> poses = PosesOf(solution);
  if (poses.empty()) return std::nullopt;
  return CovarianceAt(place, Nearest(place, poses));
}

RasterStrips WithSigmas(const RasterStrips& map, const Solution& solution) {
  const std::vector<UncertainPose> poses = PosesOf(solution);
  if (poses.empty()) return map;
  RasterStrips result = map;
  result.has_sigma = true;
  result.read = [read = map.read, tiles = SigmaTiles(map, poses)](std::int64_t min_row, int height) {
    SiteRaster rows = read(min_row, height);
    tiles.Fill(&rows);
    return rows;
  };
  return result;
}

}  // namespace survey
