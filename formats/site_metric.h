// SPDX-License-Identifier: Apache-2.0
//
// What a metre of a site means: a distance on the grid of a projection, or one as the control's own plane has it. Said
// in the tags of every raster and on the certificate, so that nobody has to guess whether to divide by the combined
// factor [survey practice: ground times factor = grid].
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "formats/grid_scale.h"
#include "formats/raster_file.h"
#include "survey/control/control_point.h"

namespace formats {

struct SiteMetric {
  std::string distances;           // "grid", "plane of the control" or "local"
  std::optional<GridScale> scale;  // of a grid, on the ellipsoid, where the projection can be inverted
};

// At a place of the frame that the label names.
SiteMetric MetricAt(const RasterLabel& label, const Eigen::Vector2d& place);

// "grid distances, metres; ground = grid / (0.99960012 R / (R + h)), R = 6383 km, h above the ellipsoid"
std::string MetricText(const SiteMetric& metric);

// For the certificate: the same with the combined factor at the middle and the mean elevation of the control.
std::string MetricSentence(const survey::ControlNetwork& network);

}  // namespace formats
