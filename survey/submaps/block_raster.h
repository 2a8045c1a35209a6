// SPDX-License-Identifier: Apache-2.0
//
// The map of a block: occupancy rendered from the scans at their final poses on the site's cells. Scans that would only
// tell the same again are not drawn: those less than a cell on from the last one, two cells where beams are dense, and
// of those taken standing still all but the first ones, which would tell of those who walk by.
#pragma once

#include <functional>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/grid/occupancy_pyramid.h"
#include "survey/grid/raster_strips.h"
#include "survey/sensors/session.h"

namespace survey {

// Which scans are drawn: those more than `way_m` or 0.01 rad on from the last one drawn, and of those within 1 cm and
// 0.003 rad (5 cm at 16 m) of where the lidar came to rest, the first 8.
std::vector<bool> DrawnScans(const std::vector<Pose2>& poses, double way_m);

struct RenderOptions {
  OccupancyOptions grid{.num_levels = 1};
  double max_range_m = 30.0;
  double free_range_m = 0.0;  // beams without return clear the space up to here; 0: they tell nothing
};

// Poses: site_from_scan of every scan, in the session's order. Cells are those of the site raster with the grid's cell
// size. A map without cells has no strips to read.
RasterStrips RenderBlock(const Session& session, const std::vector<Pose2>& site_from_scan, const RenderOptions& options,
                         const std::function<void(std::size_t)>& progress = {});

}  // namespace survey
