// SPDX-License-Identifier: Apache-2.0
//
// Loop closures of a block, [CN] section 2.3 and [Hess16] section V: nodes are searched in submaps that they did not
// help to draw. Offline the search comes after the track, in rounds: windows follow the drift that is possible along
// the shortest way through the graph, so that they shrink as loops close. Wide windows are searched by branch and bound
// at a few nodes; in narrow ones the match itself finds the pose, at many of them. Loops must agree with each other
// before they enter, and with the whole graph to stay.
#pragma once

#include <functional>

#include "survey/graph/loop_place.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

struct LoopOptions {
  PlaceOptions place;
  double max_range_m = 30.0;
  double node_spacing_m = 1.5;            // one node per this much path is searched in each submap
  std::size_t max_nodes_per_submap = 48;  // in narrow windows: the nearest, more tell the same again
  double min_detour_m = 15.0;             // nodes closer to the submap along the track are not loops
  double reach_m = 6.0;          // a node is searched in submaps whose nodes come this close, plus the possible drift
  double drift_m_per_m = 0.006;  // sigma of the drift of the position along the way
  double drift_rad_per_sqrt_m = 0.004;  // sigma of the heading along the way
  double max_window_m = 12.0;
  double max_window_rad = 0.6;
  double min_score_ratio = 0.75;  // of the submap's own nodes: below, a match is no loop
  double min_overlap = 0.7;       // share of end points that must fall on cells the submap has seen
};

Loops FindLoops(const Session& session, const Track& track, const LoopOptions& options,
                const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace survey
