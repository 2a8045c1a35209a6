// SPDX-License-Identifier: Apache-2.0
//
// How uncertain a node's place is relative to a submap: by the shortest way between them, along the track or through
// loops that are closed already.
#pragma once

#include <vector>

#include "survey/graph/block_graph.h"
#include "survey/submaps/track.h"

namespace survey {

class LoopWays {
 public:
  // way_along: of each of the block's nodes along the track, m; longer where the track drifts more than usual.
  LoopWays(const Track& track, const BlockGraph& block, const std::vector<double>& way_along);

  // Joins what a closed loop ties; it counts as kLoopLength_m.
  void Close(int node, SubmapId submap);

  // Shortest way from the submap to every node, m.
  std::vector<double> From(SubmapId submap) const;

 private:
  struct Arc {
    std::size_t to;
    double length;
  };
  void Connect(std::size_t a, std::size_t b, double length);

  std::size_t num_nodes_;
  std::vector<std::vector<Arc>> arcs_;  // of the nodes, then of the submaps
};

}  // namespace survey
