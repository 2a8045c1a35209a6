// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/block_raster.h"

#include <algorithm>
#include <cmath>

#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

// The part of the pyramid that was observed, as a raster whose cells count from the site's origin.
SiteRaster CutToObserved(const OccupancyPyramid& grid, std::int64_t offset_column, std::int64_t offset_row) {
  const OccupancyPyramid::Extent extent = grid.ExtentOf(0);
  int low_column = extent.width;
  int high_column = -1;
  int low_row = extent.height;
  int high_row = -1;
  for (int row = 0; row < extent.height; ++row) {
    for (int column = 0; column < extent.width; ++column) {
      if (grid.At(0, extent.min_column + column, extent.min_row + row) == OccupancyPyramid::kUnknown) continue;
      low_column = std::min(low_column, column);
      high_column = std::max(high_column, column);
      low_row = std::min(low_row, row);
      high_row = std::max(high_row, row);
    }
  }
  SiteRaster raster{.cell_size_m = grid.cell_size_m()};
  if (high_column < 0) return raster;
  raster.min_column = offset_column + extent.min_column + low_column;
  raster.min_row = offset_row + extent.min_row + low_row;
  raster.width = high_column - low_column + 1;
  raster.height = high_row - low_row + 1;
  raster.log_odds.reserve(static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height));
  for (int row = low_row; row <= high_row; ++row) {
    for (int column = low_column; column <= high_column; ++column) {
      raster.log_odds.push_back(grid.LogOddsOf(grid.At(0, extent.min_column + column, extent.min_row + row)));
    }
  }
  return raster;
}

}  // namespace

std::vector<bool> DrawnScans(const std::vector<Pose2>& poses, double cell_size_m) {
  constexpr double kAtRest_m = 0.01;
  constexpr double kAtRest_rad = 0.003;
  constexpr int kMostAtRest = 8;
  constexpr double kTurned_rad = 0.01;
  const auto near = [&](std::size_t i, std::size_t j, double distance_m, double angle_rad) {
    const Pose2 motion = Between(poses[i], poses[j]);
    return motion.Translation().norm() <= distance_m && std::abs(motion.theta) <= angle_rad;
  };
  std::vector<bool> drawn(poses.size(), true);
  std::size_t first = 0;  // of the scans at this place
  std::size_t last = 0;   // drawn before
  int count = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!near(first, i, kAtRest_m, kAtRest_rad)) {
      first = i;
      count = 0;
    }
    const bool at_rest = ++count > 1;
    drawn[i] = at_rest ? count <= kMostAtRest : i == 0 || !near(last, i, cell_size_m, kTurned_rad);
    if (drawn[i]) last = i;
  }
  return drawn;
}

SiteRaster RenderBlock(const Session& session, const std::vector<Pose2>& site_from_scan, const RenderOptions& options,
                       const std::function<void(std::size_t)>& progress) {
  OccupancyPyramid grid(options.grid);
  if (site_from_scan.empty()) return CutToObserved(grid, 0, 0);
  // Northings of millions of metres do not fit into floats: draw in a frame moved by whole cells.
  const double cell = options.grid.cell_size_m;
  const auto offset_column = static_cast<std::int64_t>(std::floor(site_from_scan.front().x / cell));
  const auto offset_row = static_cast<std::int64_t>(std::floor(site_from_scan.front().y / cell));
  const Eigen::Vector2d offset(static_cast<double>(offset_column) * cell, static_cast<double>(offset_row) * cell);

  const ScanProjector projector(session.geometries, options.max_range_m, options.free_range_m);
  ScanPoints points;
  std::vector<Eigen::Vector2f> hits;
  std::vector<Eigen::Vector2f> free_ends;
  const auto pose_of = [&](std::size_t i) {
    return Pose2{site_from_scan[i].x - offset.x(), site_from_scan[i].y - offset.y(), site_from_scan[i].theta};
  };
  const std::vector<bool> drawn = DrawnScans(site_from_scan, cell);
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    if (!drawn[i]) continue;
    projector.Project(session, i, TwistOfScan(session.scans, pose_of, i), &points);
    const Pose2 pose = pose_of(i);
    TransformPoints(pose, points.hits, &hits);
    TransformPoints(pose, points.free_ends, &free_ends);
    grid.Insert(pose.Translation().cast<float>(), hits, free_ends);
    if (progress) progress(i + 1);
  }
  return CutToObserved(grid, offset_column, offset_row);
}

}  // namespace survey
