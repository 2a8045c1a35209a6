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

}  // namespace

std::optional<Eigen::Matrix2d> MapCovarianceAt(const Eigen::Vector2d& place, const Solution& solution) {
  const std::vector<UncertainPose> poses = PosesOf(solution);
  if (poses.empty()) return std::nullopt;
  return CovarianceAt(place, Nearest(place, poses));
}

void FillSigmas(const Solution& solution, SiteRaster* raster) {
  const std::vector<UncertainPose> poses = PosesOf(solution);
  if (poses.empty()) return;
  const int tile = std::max(1, static_cast<int>(kTile_m / raster->cell_size_m));
  raster->sigma_m.assign(raster->log_odds.size(), std::numeric_limits<float>::quiet_NaN());
  for (int first_row = 0; first_row < raster->height; first_row += tile) {
    const int end_row = std::min(raster->height, first_row + tile);
    for (int first_column = 0; first_column < raster->width; first_column += tile) {
      const int end_column = std::min(raster->width, first_column + tile);
      const Eigen::Vector2d centre =
          (raster->CentreOf(first_column, first_row) + raster->CentreOf(end_column - 1, end_row - 1)) / 2.0;
      const Eigen::Matrix2d covariance = CovarianceAt(centre, Nearest(centre, poses));
      const auto sigma = static_cast<float>(std::sqrt(std::max(0.0, PrincipalAxesOf(covariance).values[1])));
      for (int row = first_row; row < end_row; ++row) {
        for (int column = first_column; column < end_column; ++column) {
          if (!std::isnan(raster->At(column, row))) raster->sigma_m[raster->Index(column, row)] = sigma;
        }
      }
    }
  }
}

}  // namespace survey
