// SPDX-License-Identifier: Apache-2.0
//
// Maps with exact truth: a lidar stands at given places among solid polygons, its noisy rays are entered into an
// occupancy raster by [CN] eq. (1) (each cell at most once a scan, hits before misses).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "survey/grid/hit_cells.h"
#include "survey/grid/site_raster.h"

namespace test_support {

using Polygon = std::vector<Eigen::Vector2d>;  // corners in the site frame (m), closed by itself

struct RenderOptions {
  double cell_size_m = 0.05;
  double range_noise_m = 0.01;
  double position_noise_m = 0.0;  // of each stand, both axes: what a trajectory leaves
  double angle_increment_rad = 0.25 * 3.14159265358979323846 / 180.0;
  double range_max_m = 30.0;
  double p_hit = 0.55;
  double p_miss = 0.49;
  double p_min = 0.12;
  double p_max = 0.97;
  int scans_per_stand = 1;
  std::uint64_t seed = 1;
};

Polygon Box(double min_x, double min_y, double max_x, double max_y);

// Rotated about a point, counter-clockwise.
Polygon Rotated(const Polygon& polygon, double angle_rad, const Eigen::Vector2d& centre);
Polygon Moved(const Polygon& polygon, const Eigen::Vector2d& by);

// Polygons without area (two corners) are thin walls. `hits`, when given, gets the end points of all rays that
// returned, in the site frame.
survey::SiteRaster RenderMap(const std::vector<Polygon>& solids, const std::vector<Eigen::Vector2d>& stands,
                             const RenderOptions& options, std::vector<Eigen::Vector2d>* hits = nullptr);

// Those of the hits within radius_m of a place, in the cells of the map.
survey::HitCells CellsOfHits(const survey::SiteRaster& map, const std::vector<Eigen::Vector2d>& hits,
                             const Eigen::Vector2d& place, double radius_m);

}  // namespace test_support
