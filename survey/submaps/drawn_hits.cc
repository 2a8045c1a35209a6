// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/drawn_hits.h"

#include "survey/submaps/block_raster.h"
#include "survey/submaps/rendering.h"

namespace survey {

HitCells DrawnHits(const Session& session, const std::vector<Pose2>& site_from_scan, double max_range_m,
                   const SiteRaster& map, std::span<const Eigen::Vector2d> places_in_site, double radius_m) {
  HitCells cells(map, places_in_site, radius_m);
  const ScanProjector projector(session.geometries, max_range_m, 0.0);
  const double corner_x = static_cast<double>(map.min_column) * map.cell_size_m;
  const double corner_y = static_cast<double>(map.min_row) * map.cell_size_m;
  const auto map_from_scan = [&](std::size_t i) {
    const Pose2& pose = site_from_scan[i];
    return Pose2{pose.x - corner_x, pose.y - corner_y, pose.theta};
  };
  const std::vector<bool> drawn = DrawnScans(site_from_scan, map.cell_size_m);
  ScanPoints points;
  std::vector<Eigen::Vector2f> hits;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    if (!drawn[i]) continue;
    projector.Project(session, i, TwistOfScan(session.scans, map_from_scan, i), &points);
    TransformPoints(map_from_scan(i), points.hits, &hits);
    cells.Add(hits);
  }
  return cells;
}

}  // namespace survey
