// SPDX-License-Identifier: Apache-2.0
//
// Positional uncertainty of a block's map from the covariances of the poses that drew it: the nearest pose that has one
// stands for a place, its errors of position and heading carried there. The range noise of the lidar is not in it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "survey/graph/solution.h"
#include "survey/grid/raster_strips.h"

namespace survey {

// Covariance (m2) of what the map shows at a place in the site; empty where the solution has no covariances.
std::optional<Eigen::Matrix2d> MapCovarianceAt(const Eigen::Vector2d& place, const Solution& solution);

// The map with sigma_m for all known cells: the larger semi-axis of the covariance, m. Where the solution has no
// covariances it stays without.
RasterStrips WithSigmas(const RasterStrips& map, const Solution& solution);

}  // namespace survey
