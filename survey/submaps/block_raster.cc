// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/block_raster.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

// Cells [low, high] of the grid's array that were observed.
struct Observed {
  Eigen::Array2i low;  // column, row
  Eigen::Array2i high;
};

std::optional<Observed> ObservedPartOf(const OccupancyPyramid& grid) {
  const OccupancyPyramid::Extent extent = grid.ExtentOf(0);
  const auto known = [](OccupancyPyramid::Evidence evidence) { return evidence != OccupancyPyramid::kUnknown; };
  Observed part{{extent.width, extent.height}, {-1, -1}};
  for (int row = 0; row < extent.height; ++row) {
    const std::span<const OccupancyPyramid::Evidence> cells = grid.Row(0, extent.min_row + row);
    const auto first = std::find_if(cells.begin(), cells.end(), known);
    if (first == cells.end()) continue;
    const auto behind = std::find_if(cells.rbegin(), cells.rend(), known).base();
    part.low = part.low.min(Eigen::Array2i(static_cast<int>(first - cells.begin()), row));
    part.high = part.high.max(Eigen::Array2i(static_cast<int>(behind - cells.begin()) - 1, row));
  }
  if (part.high.y() < 0) return std::nullopt;
  return part;
}

// What was observed, as a raster whose cells count from the site's origin.
RasterStrips StripsOfDrawing(OccupancyPyramid&& drawn, std::int64_t offset_column, std::int64_t offset_row) {
  const auto grid = std::make_shared<const OccupancyPyramid>(std::move(drawn));
  RasterStrips strips{.frame = {.cell_size_m = grid->cell_size_m()}};
  const std::optional<Observed> part = ObservedPartOf(*grid);
  if (!part) return strips;
  const OccupancyPyramid::Extent extent = grid->ExtentOf(0);
  strips.frame.min_column = offset_column + extent.min_column + part->low.x();
  strips.frame.min_row = offset_row + extent.min_row + part->low.y();
  strips.frame.width = part->high.x() - part->low.x() + 1;
  strips.frame.height = part->high.y() - part->low.y() + 1;
  strips.read = [grid, frame = strips.frame, offset_row, first_column = static_cast<std::size_t>(part->low.x())](
                    std::int64_t min_row, int height) {
    SiteRaster rows = RowsOf(frame, min_row, height);
    const auto width = static_cast<std::size_t>(frame.width);
    rows.log_odds.reserve(width * static_cast<std::size_t>(height));
    for (std::int64_t row = min_row; row < min_row + height; ++row) {
      for (const OccupancyPyramid::Evidence evidence :
           grid->Row(0, static_cast<int>(row - offset_row)).subspan(first_column, width))
        rows.log_odds.push_back(grid->LogOddsOf(evidence));
    }
    return rows;
  };
  return strips;
}

// A cell, or two where the beams are so dense that two of them cross a cell at the usual distance.
double WayBetweenDrawn(std::span<const ScanGeometry> geometries, double cell_size_m) {
  constexpr double kUsualRange_m = 5.0;
  const bool dense = std::all_of(geometries.begin(), geometries.end(), [&](const ScanGeometry& geometry) {
    return 2.0 * kUsualRange_m * std::abs(geometry.angle_increment_rad) <= cell_size_m;
  });
  return dense ? 2.0 * cell_size_m : cell_size_m;
}

}  // namespace

std::vector<bool> DrawnScans(const std::vector<Pose2>& poses, double way_m) {
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
    drawn[i] = at_rest ? count <= kMostAtRest : i == 0 || !near(last, i, way_m, kTurned_rad);
    if (drawn[i]) last = i;
  }
  return drawn;
}

RasterStrips RenderBlock(const Session& session, const std::vector<Pose2>& site_from_scan, const RenderOptions& options,
                         const std::function<void(std::size_t)>& progress) {
  OccupancyPyramid grid(options.grid);
  if (site_from_scan.empty()) return StripsOfDrawing(std::move(grid), 0, 0);
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
  const std::vector<bool> drawn = DrawnScans(site_from_scan, WayBetweenDrawn(session.geometries, cell));
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    if (!drawn[i]) continue;
    projector.Project(session, i, TwistOfScan(session.scans, pose_of, i), &points);
    const Pose2 pose = pose_of(i);
    TransformPoints(pose, points.hits, &hits);
    TransformPoints(pose, points.free_ends, &free_ends);
    grid.Insert(pose.Translation().cast<float>(), hits, free_ends);
    if (progress) progress(i + 1);
  }
  return StripsOfDrawing(std::move(grid), offset_column, offset_row);
}

}  // namespace survey
