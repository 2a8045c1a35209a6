// SPDX-License-Identifier: Apache-2.0
//
// A block's track as a pose graph: submaps and nodes are its poses, [CN] eq. (8). Used by the loop search (without
// control) and by the adjustment (with it).
#pragma once

#include <vector>

#include "survey/graph/pose_graph.h"
#include "survey/submaps/track.h"

namespace survey {

struct BlockGraph {
  PoseGraph graph;            // poses: submaps first, then nodes in order of time; points: those marked, by name
  std::vector<ScanId> nodes;  // scan of each node, ascending
  std::vector<std::string> point_names;

  int PoseOf(SubmapId submap) const { return submap.value; }
  int PoseOf(ScanId node) const;  // the node must exist
  std::size_t num_submaps = 0;
};

// Nothing told where the scan lies but odometry or constant velocity.
bool GoneBlind(const TrackedScan& scan);

// The last node at or before a scan, or the first node.
ScanId NodeNear(const BlockGraph& block, ScanId scan);

// Poses start where the track has them (local frame), the first submap is held. Same-point marks tie together.
BlockGraph MakeBlockGraph(const Track& track);

// The same with some of the nodes only, ascending, among them all that carry marks: a coarser trajectory that bends as
// the whole one does.
BlockGraph MakeBlockGraph(const Track& track, const std::vector<ScanId>& nodes);

// Of the whole track with the loops that were accepted.
BlockGraph MakeBlockGraph(const Track& track, const Loops& loops);

void AddLoop(const SubmapConstraint& loop, BlockGraph* block);

// Poses of all scans after the nodes have moved: the track between two nodes is bent to fit both.
std::vector<Pose2> PosesOfAllScans(const Track& track, const BlockGraph& block, const std::vector<StampNs>& stamps);

}  // namespace survey
