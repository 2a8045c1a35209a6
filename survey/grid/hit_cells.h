// SPDX-License-Identifier: Apache-2.0
//
// Where in the cells of a map rays ended: number and mean place of the hits of each quarter of a cell. That a wall runs
// through a cell the map tells; where in the cell, its hits do: their errors have no side, whatever the noise of the
// ranges.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

// A quarter of a cell with hits: their mean place (m) and number.
struct HitCell {
  Eigen::Vector2d p;
  double hits = 0.0;
};

// Of the cells of a map that lie near some places; hits elsewhere are not kept.
class HitCells {
 public:
  // Keeps what lies within radius_m of one of the places (site frame).
  HitCells(const SiteRaster& map, std::span<const Eigen::Vector2d> places_in_site, double radius_m);

  // End points, m from the south-west corner of the map.
  void Add(std::span<const Eigen::Vector2f> points_in_map);

  // Hits in cells within radius_m of a place in the site, which becomes their origin; row by row.
  std::vector<HitCell> Near(const Eigen::Vector2d& p_in_site, double radius_m) const;

 private:
  struct Sum {
    Eigen::Vector2d p_in_map = Eigen::Vector2d::Zero();
    std::int64_t hits = 0;
  };
  using Quarters = std::array<Sum, 4>;

  // Calls visit(cell) for the cells of the map whose centre lies within radius_m of a place, row by row.
  template <typename Visit>
  void ForEachCellNear(const Eigen::Vector2d& p_in_site, double radius_m, const Visit& visit) const;

  SiteRaster frame_;                                    // without cells of its own
  std::vector<bool> is_near_;                           // by cell of the map
  std::unordered_map<std::size_t, Quarters> quarters_;  // of near cells with hits; looked up, never walked through
};

}  // namespace survey
