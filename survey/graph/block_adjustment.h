// SPDX-License-Identifier: Apache-2.0
//
// The adjustment of one block with its control points, [CN] section 2.3: free solution first, then a rigid fit on the
// marks (eq. 11), then everything together, control coordinates being observations with their covariance; blunders
// among them are left out and explained. Without control the free solution stands, in the block's local frame.
#pragma once

#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/graph/answer_factors.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/controlled_graph.h"
#include "survey/graph/solution.h"
#include "survey/submaps/track.h"

namespace survey {

struct BlockAdjustmentOptions {
  ControlTieOptions tie;
  bool allow_single_point = false;  // one control point fixes the place but not the direction
  double covariance_spacing_m =
      2.0;  // covariances are computed for a node per this much path, and for every marked node
};

struct BlockAdjustment {
  bool usable = false;
  std::string message;     // why not
  NetworkFactors factors;  // applied to the covariances of track and loops
  Solution solution;
  ControlledGraph graph;
  std::vector<AnswerTest> answers;  // those in the site frame, then the others that observe something
};

// Loops that were not accepted are left out. `control` holds the block's points of role control and tie; marks on other
// points are positions only. `stamps`: of all scans, in the track's order.
BlockAdjustment AdjustBlock(const Track& track, const Loops& loops, const ControlNetwork& control,
                            const std::vector<StampNs>& stamps, const BlockAdjustmentOptions& options,
                            const Answers& answers = {});

}  // namespace survey
