// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/hit_cells.h"

#include <algorithm>
#include <cmath>

namespace survey {

using Eigen::Vector2d;

template <typename Visit>
void HitCells::ForEachCellNear(const Vector2d& p_in_site, double radius_m, const Visit& visit) const {
  const auto middle = frame_.CellOf(p_in_site);
  const std::int64_t reach = std::llround(radius_m / frame_.cell_size_m) + 1;
  for (std::int64_t row = middle.y() - reach; row <= middle.y() + reach; ++row) {
    for (std::int64_t column = middle.x() - reach; column <= middle.x() + reach; ++column) {
      if (!frame_.Contains(column, row)) continue;
      const auto c = static_cast<int>(column);
      const auto r = static_cast<int>(row);
      if ((frame_.CentreOf(c, r) - p_in_site).norm() <= radius_m) visit(frame_.Index(c, r));
    }
  }
}

HitCells::HitCells(const SiteRaster& map, std::span<const Vector2d> places_in_site, double radius_m)
    : frame_{.cell_size_m = map.cell_size_m,
             .min_column = map.min_column,
             .min_row = map.min_row,
             .width = map.width,
             .height = map.height},
      is_near_(map.log_odds.size(), false) {
  for (const Vector2d& place : places_in_site)
    ForEachCellNear(place, radius_m, [this](std::size_t cell) { is_near_[cell] = true; });
}

void HitCells::Add(std::span<const Eigen::Vector2f> points_in_map) {
  const auto cells_per_m = static_cast<float>(1.0 / frame_.cell_size_m);
  for (const Eigen::Vector2f& p : points_in_map) {
    const Eigen::Vector2f in_cells = p * cells_per_m;
    const Eigen::Vector2f cell = in_cells.array().floor();
    const auto column = static_cast<std::int64_t>(cell.x());
    const auto row = static_cast<std::int64_t>(cell.y());
    if (!frame_.Contains(column, row)) continue;
    const std::size_t index = frame_.Index(static_cast<int>(column), static_cast<int>(row));
    if (!is_near_[index]) continue;
    const Eigen::Vector2f within = in_cells - cell;
    const std::size_t quarter = (within.x() < 0.5F ? 0U : 1U) + (within.y() < 0.5F ? 0U : 2U);
    Sum& sum = quarters_[index][quarter];
    sum.p_in_map += p.cast<double>();
    ++sum.hits;
  }
}

std::vector<HitCell> HitCells::Near(const Vector2d& p_in_site, double radius_m) const {
  const Vector2d corner(static_cast<double>(frame_.min_column) * frame_.cell_size_m,
                        static_cast<double>(frame_.min_row) * frame_.cell_size_m);
  std::vector<HitCell> cells;
  ForEachCellNear(p_in_site, radius_m, [&](std::size_t cell) {
    const auto quarters = quarters_.find(cell);
    if (quarters == quarters_.end()) return;
    for (const Sum& sum : quarters->second) {
      const auto hits = static_cast<double>(sum.hits);
      if (sum.hits > 0) cells.push_back({sum.p_in_map / hits + (corner - p_in_site), hits});
    }
  });
  return cells;
}

}  // namespace survey
