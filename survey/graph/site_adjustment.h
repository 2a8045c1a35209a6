// SPDX-License-Identifier: Apache-2.0
//
// The joint adjustment of a site's blocks: the observations of all blocks as their own adjustments weighted them, the
// control network once for all of them, and relative matches between blocks under a robust loss. Sparse least squares:
// a block's trajectory hangs on the others by matches and shared control points alone. [CN] eq. (8)-(11).
#pragma once

#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/graph/controlled_graph.h"
#include "survey/graph/joint_summary.h"
#include "survey/graph/solution.h"
#include "survey/submaps/track.h"

namespace survey {

struct SiteBlock {
  std::string name;
  ControlledGraph graph;
  std::vector<Eigen::Matrix3d> covariances;  // afterwards: of the graph's poses; empty: the block stays as it was
};

// Scans of block `second` in submaps of block `first`, indices into the blocks.
struct MatchedPair {
  std::size_t first = 0;
  std::size_t second = 0;
  std::vector<Loop> matches;
};

struct SiteAdjustment {
  bool usable = false;
  std::string message;  // why not
  JointSummary summary;
};

// Moves the blocks' graphs to the joint solution. `robust_scale`: in sigmas; beyond, a match loses weight.
SiteAdjustment AdjustSite(const ControlNetwork& control, double robust_scale, std::vector<SiteBlock>* blocks,
                          std::vector<MatchedPair> pairs);

// Carries a block's solution over to the joint one: all scans, submaps, covariances and marks; the tests stay those of
// its own adjustment. `track`: in the site frame as it was (TrackInSite); `block`: as AdjustSite left it.
JointBlock MoveSolution(const SiteBlock& block, const Track& track, const std::vector<StampNs>& stamps,
                        Solution* solution);

}  // namespace survey
