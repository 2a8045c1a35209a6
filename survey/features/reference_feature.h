// SPDX-License-Identifier: Apache-2.0
//
// Corners and pillar centres in a plane reference (points of a terrestrial scanner): lines and circles fitted to the
// points themselves, so the places are good to a millimetre or two.
#pragma once

#include <Eigen/Core>
#include <span>

#include "survey/features/feature.h"
#include "survey/features/point_lines.h"

namespace survey {

struct ReferenceFeatureOptions {
  double search_radius_m = 0.4;  // a feature is looked for this far from its rough place
  double face_length_m = 0.8;    // faces are followed this far
  PointLineOptions lines;        // of circles too
};

// `points` are those around the rough place, site frame (m). What is not seen, or could be two things, is not found and
// says why. The covariance is that of the fit.
MapFeature LocateInReference(std::span<const Eigen::Vector2d> points, const NamedFeature& wanted,
                             const ReferenceFeatureOptions& options);

}  // namespace survey
