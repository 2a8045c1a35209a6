// SPDX-License-Identifier: Apache-2.0
//
// How control comes from the system that it was surveyed in into the site's projected system: a tie of the site grid,
// or ground coordinates scaled down to the grid. Positions, covariances and correlations change alike.
#pragma once

#include <Eigen/Core>
#include <string>

#include "survey/control/control_point.h"
#include "survey/control/site_tie.h"

namespace survey {

// Adds a remark with parameters and residuals.
void ApplySiteTie(const SiteTie& tie, const std::vector<TiePoint>& points, ControlNetwork* network);

// grid = origin + factor * (ground - origin). Adds a remark.
void ReduceToGrid(double combined_factor, const Eigen::Vector2d& origin, ControlNetwork* network);

}  // namespace survey
