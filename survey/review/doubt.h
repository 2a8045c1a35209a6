// SPDX-License-Identifier: Apache-2.0
//
// Causes for doubt about the poses of a block, from everything that is known when it has been adjusted: what the front
// end could not match, particles that disagree, loops that were not believed, marks that do not fit their control
// points, passes that contradict each other. Poses in the frame of the solution; m, rad.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "survey/accuracy/contradiction.h"
#include "survey/graph/solution.h"
#include "survey/submaps/track.h"

namespace survey {

// Another pose that something speaks for.
struct PoseMode {
  std::string cause;
  Pose2 site_from_scan;
  double weight = 0.0;  // share of particles or score of a match, 0..1
};

struct ScanRange {
  ScanId first, last;
};

struct Doubt {
  std::string cause;
  ScanId scan;          // asked about
  ScanRange stretch;    // what stands or falls with it
  double size_m = 0.0;  // by how much the pose may be off
  std::string message;
  std::vector<PoseMode> modes;       // of `scan`
  std::optional<ScanRange> against;  // the pass that speaks against it
};

struct BlockEvidence {
  const Track& track;
  const Loops& loops;
  const Solution& solution;
  const std::vector<StampNs>& stamps;  // of all scans
  const std::vector<PassConflict>& conflicts;
};

// In order of the stretches' first scans.
std::vector<Doubt> FindDoubts(const BlockEvidence& evidence);

}  // namespace survey
