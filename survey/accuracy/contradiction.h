// SPDX-License-Identifier: Apache-2.0
//
// Contradiction of a map with itself: the share of the wall cells of one pass that lie where another pass looked
// through and saw no wall near. Doubled walls raise it, whatever the true poses are, so it needs no truth.
#pragma once

#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace survey {

struct ContradictionOptions {
  double cell_size_m = 0.1;
  double max_range_m = 10.0;
  double piece_m = 6.0;   // path of one pass: its scans are drawn together
  double apart_m = 15.0;  // path between two passes
  double drawn_every_m = 0.2;
  int min_hits = 2;          // of a wall cell
  int min_rays = 3;          // through a cell that was seen through
  double wall_near_m = 0.5;  // a wall of the other pass so near excuses
};

struct Contradiction {
  int compared = 0;      // wall cells that another pass saw or saw through, by pairs of passes
  int contradicted = 0;  // of these: seen through
  double Share() const { return compared > 0 ? static_cast<double>(contradicted) / compared : 0.0; }
};

// `poses`: of all scans of the session in one frame.
Contradiction ContradictionOfPasses(const Session& session, const std::vector<Pose2>& poses,
                                    const ContradictionOptions& options);

}  // namespace survey
