// SPDX-License-Identifier: Apache-2.0
//
// The hits that drew a block's map, near some places.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/grid/hit_cells.h"
#include "survey/sensors/session.h"

namespace survey {

// Poses: site_from_scan of every scan, in the session's order. Of one scan for each cell of the way (see DrawnScans).
HitCells DrawnHits(const Session& session, const std::vector<Pose2>& site_from_scan, double max_range_m,
                   const SiteRaster& map, std::span<const Eigen::Vector2d> places_in_site, double radius_m);

}  // namespace survey
