// SPDX-License-Identifier: Apache-2.0
//
// Which scan drew a cell: for people's edits, which hang on the scans that drew what they saw
// (survey/edits/anchoring.h). Where a map shows a thing twice, each copy belongs to its own pass.
#pragma once

#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/grid/site_raster.h"
#include "survey/sensors/session.h"

namespace survey {

struct WitnessOptions {
  double spacing_m = 0.5;  // one scan is asked for each such length of the path ...
  double turn_rad = 0.35;  // ... or turn
  double max_range_m = 30.0;
};

// Fills raster->drawn_by. A scan speaks for an occupied cell by an end point in it, for a free one by a ray through it;
// the stretch of the path with the majority [BoyerMoore91] has the cell, and in it the scan that saw it from nearest.
// NaN where none of the asked scans speaks. For a part of a map only the rays that meet it cost.
void FillDrawnBy(const Session& session, const std::vector<Pose2>& site_from_scan, const WitnessOptions& options,
                 SiteRaster* raster);

}  // namespace survey
