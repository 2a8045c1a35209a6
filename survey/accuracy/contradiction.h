// SPDX-License-Identifier: Apache-2.0
//
// Contradiction of a map with itself: the share of the wall cells of one pass that lie where another pass looked
// through and saw no wall near. Doubled walls raise it, whatever the true poses are, so it needs no truth.
#pragma once

#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

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
  // From where on two passes are a conflict:
  int conflict_cells = 20;       // contradicted, and
  double conflict_share = 0.15;  // of those compared
};

struct Contradiction {
  int compared = 0;      // wall cells that another pass saw or saw through, by pairs of passes
  int contradicted = 0;  // of these: seen through
  double Share() const { return compared > 0 ? static_cast<double>(contradicted) / compared : 0.0; }
  Contradiction& operator+=(const Contradiction& other) {
    compared += other.compared;
    contradicted += other.contradicted;
    return *this;
  }
};

// Two pieces of the way whose walls contradict each other: scans of the later one and of the earlier one.
struct PassConflict {
  ScanId first, last;
  ScanId other_first, other_last;
  Contradiction walls;  // of each against the other
};

struct PassComparison {
  Contradiction total;  // over all pairs of passes
  std::vector<PassConflict>
      conflicts;  // in order of the later pass, each with the earlier one that it contradicts most
};

// `poses`: of all scans of the session in one frame.
PassComparison ComparePasses(const Session& session, const std::vector<Pose2>& poses,
                             const ContradictionOptions& options);

}  // namespace survey
