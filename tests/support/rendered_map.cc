// SPDX-License-Identifier: Apache-2.0
#include "tests/support/rendered_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "survey/geometry/pose2.h"
#include "survey/grid/line_cells.h"
#include "survey/stats/philox.h"

namespace test_support {
namespace {

using Eigen::Vector2d;
using survey::SiteRaster;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double RangeTo(const std::vector<Polygon>& solids, const Vector2d& from, const Vector2d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Polygon& polygon : solids) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d a = polygon[i];
      const Vector2d edge = polygon[(i + 1) % polygon.size()] - a;
      const double determinant = Cross(direction, edge);
      if (std::abs(determinant) < 1e-12) continue;
      const double range = Cross(a - from, edge) / determinant;
      const double along = Cross(a - from, direction) / determinant;
      if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
    }
  }
  return nearest;
}

SiteRaster EmptyAround(const std::vector<Vector2d>& stands, const RenderOptions& options) {
  Vector2d low = stands.front();
  Vector2d high = stands.front();
  for (const Vector2d& stand : stands) {
    low = low.cwiseMin(stand);
    high = high.cwiseMax(stand);
  }
  const double reach = options.range_max_m + 1.0;
  SiteRaster raster{.cell_size_m = options.cell_size_m};
  raster.min_column = static_cast<std::int64_t>(std::floor((low.x() - reach) / options.cell_size_m));
  raster.min_row = static_cast<std::int64_t>(std::floor((low.y() - reach) / options.cell_size_m));
  raster.width = static_cast<int>((high.x() - low.x() + 2 * reach) / options.cell_size_m) + 2;
  raster.height = static_cast<int>((high.y() - low.y() + 2 * reach) / options.cell_size_m) + 2;
  raster.log_odds.assign(static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height),
                         survey::kUnknownLogOdds);
  return raster;
}

double LogOdds(double p) { return std::log(p / (1 - p)); }

// Cells of one scan: each is entered once, hits first.
class ScanCells {
 public:
  explicit ScanCells(SiteRaster* raster) : raster_(raster), last_scan_(raster->log_odds.size(), -1) {}

  void EnterEnd(const Vector2d& p, int scan, double log_odds, const RenderOptions& options) {
    const auto cell = raster_->CellOf(p);
    Enter(cell.x(), cell.y(), scan, log_odds, options);
  }

  void EnterLine(const Vector2d& from, const Vector2d& to, int scan, double log_odds, const RenderOptions& options) {
    survey::ForEachCellOnLine(InCells(from), InCells(to),
                              [&](int column, int row) { Enter(column, row, scan, log_odds, options); });
  }

 private:
  Eigen::Vector2f InCells(const Vector2d& p) const {
    const Vector2d origin(static_cast<double>(raster_->min_column), static_cast<double>(raster_->min_row));
    return (p / raster_->cell_size_m - origin).cast<float>();
  }

  void Enter(std::int64_t column, std::int64_t row, int scan, double log_odds, const RenderOptions& options) {
    if (!raster_->Contains(column, row)) return;
    const std::size_t index = static_cast<std::size_t>(row * raster_->width + column);
    if (last_scan_[index] == scan) return;
    last_scan_[index] = scan;
    float& value = raster_->log_odds[index];
    value = static_cast<float>(
        std::clamp((std::isnan(value) ? 0.0 : value) + log_odds, LogOdds(options.p_min), LogOdds(options.p_max)));
  }

  SiteRaster* raster_;
  std::vector<int> last_scan_;
};

}  // namespace

Polygon Box(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

Polygon Rotated(const Polygon& polygon, double angle_rad, const Vector2d& centre) {
  Polygon rotated;
  for (const Vector2d& p : polygon) rotated.push_back(centre + survey::Rotation2(angle_rad) * (p - centre));
  return rotated;
}

Polygon Moved(const Polygon& polygon, const Vector2d& by) {
  Polygon moved;
  for (const Vector2d& p : polygon) moved.push_back(p + by);
  return moved;
}

SiteRaster RenderMap(const std::vector<Polygon>& solids, const std::vector<Vector2d>& stands,
                     const RenderOptions& options, std::vector<Vector2d>* all_hits) {
  SiteRaster raster = EmptyAround(stands, options);
  const int beams = static_cast<int>(2 * std::numbers::pi / options.angle_increment_rad);
  ScanCells cells(&raster);
  for (std::size_t scan = 0; scan < stands.size() * static_cast<std::size_t>(options.scans_per_stand); ++scan) {
    const survey::RandomStream noise(options.seed, 1, static_cast<std::uint32_t>(scan));
    const Vector2d stand = stands[scan / static_cast<std::size_t>(options.scans_per_stand)];
    const auto [dx, dy] = noise.Normals(1000000);
    const double turn = noise.Uniform(1000001) * options.angle_increment_rad;
    const Vector2d believed = stand + options.position_noise_m * Vector2d(dx, dy);
    std::vector<Vector2d> ends;
    std::vector<bool> hits;
    for (int beam = 0; beam < beams; ++beam) {
      const double angle = beam * options.angle_increment_rad + turn;
      const Vector2d direction(std::cos(angle), std::sin(angle));
      const double range = RangeTo(solids, stand, direction);
      const bool returned = range <= options.range_max_m;
      const double measured = returned ? range + options.range_noise_m * noise.Normal(static_cast<std::uint64_t>(beam))
                                       : options.range_max_m;
      const Vector2d end = believed + measured * direction;
      ends.push_back(end);
      if (returned && all_hits != nullptr) all_hits->push_back(end);
      hits.push_back(returned);
    }
    const int number = static_cast<int>(scan);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (hits[i]) cells.EnterEnd(ends[i], number, LogOdds(options.p_hit), options);
    }
    for (const Vector2d& end : ends) cells.EnterLine(believed, end, number, LogOdds(options.p_miss), options);
  }
  return raster;
}

survey::HitCells CellsOfHits(const SiteRaster& map, const std::vector<Vector2d>& hits, const Vector2d& place,
                             double radius_m) {
  survey::HitCells cells(map, std::span(&place, 1), radius_m);
  const Vector2d corner(static_cast<double>(map.min_column) * map.cell_size_m,
                        static_cast<double>(map.min_row) * map.cell_size_m);
  std::vector<Eigen::Vector2f> in_map;
  for (const Vector2d& hit : hits) in_map.push_back((hit - corner).cast<float>());
  cells.Add(in_map);
  return cells;
}

}  // namespace test_support
