// SPDX-License-Identifier: Apache-2.0
//
// Where two blocks of a site have seen the same place: scans of the second block matched to submaps of the first
// ([CN] section 5 names such relative matches as what could follow after control). Both lie where their own adjustment
// put them, which is near enough for the match itself to find the pose.
#pragma once

#include <vector>

#include "survey/graph/loop_place.h"
#include "survey/graph/solution.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

struct BlockMatchOptions {
  PlaceOptions place;
  double max_range_m = 30.0;
  double node_spacing_m = 1.5;    // one scan per this much path is matched
  double reach_m = 12.0;          // in submaps of the other block whose nodes come this close
  double min_score_ratio = 0.75;  // of the submap's own nodes: below, a match is none
  double min_overlap = 0.7;       // share of end points that must fall on cells the submap has seen
};

// The track of a block with its poses in the site frame, as the adjustment left them.
Track TrackInSite(const Track& track, const Solution& solution);

// A block as it is matched. Tracks are those of TrackInSite.
struct MatchedBlock {
  const Session* session = nullptr;
  const Track* track = nullptr;
};

// Scans of `second` in submaps of `first`, in order of submap and scan. Those that contradict their neighbours are not
// accepted. The covariances are those of the matches alone.
std::vector<Loop> MatchBlocks(const MatchedBlock& first, const MatchedBlock& second, const BlockMatchOptions& options);

}  // namespace survey
