// SPDX-License-Identifier: Apache-2.0
//
// Search of a small pose window on a coarse level of the pyramid ([CN] section 2.1: a rough pose on the
// lower-resolution layer first), for predictions that are too uncertain for Gauss-Newton alone.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/grid/occupancy_pyramid.h"

namespace survey {

struct CoarseSearchOptions {
  int level = 1;              // of the pyramid
  std::size_t max_modes = 4;  // best local maxima to return
};

// Poses of the highest mean occupancy in the window, best first, at least two steps apart from each other. The step is
// one cell of the level in translation and one cell at the scan's mean range in rotation.
std::vector<Pose2> CoarseSearch(const OccupancyPyramid& map, std::span<const Eigen::Vector2f> points_in_scan,
                                const Pose2& centre, double half_width_m, double half_angle_rad,
                                const CoarseSearchOptions& options);

}  // namespace survey
