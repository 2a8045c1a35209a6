// SPDX-License-Identifier: Apache-2.0
//
// The centre of a free-standing pillar in a plane reference: round, by the circle through its points, or with straight
// faces, by the middles of opposite ones. A scanner often sees three faces of four: then the pillar is taken as square.
#pragma once

#include <vector>

#include "survey/features/point_lines.h"

namespace survey {

// Pillars that the points may show, in their frame, with the covariance of the fit. Round first: what lies on a circle
// has no faces.
std::vector<PointCrossing> FindPillars(const std::vector<Eigen::Vector2d>& points, const PointLineOptions& options);

}  // namespace survey
