// SPDX-License-Identifier: Apache-2.0
//
// What the adjustment of a block leaves for that of the whole site: its own observations with their final weights
// (variance factors applied, robust loss frozen, marks that were left out hanging on points of their own), and which
// control points took part. Their given coordinates are not in it: the site's network gives them, once for all blocks.
// What people gave for points of the block's own is, one by one (KeepArrows in survey/edits/map_arrow.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "survey/graph/block_graph.h"

namespace survey {

struct ControlledGraph {
  BlockGraph block;                  // poses and points in the site frame, in the order of its adjustment
  std::optional<int> site_pose;      // behind the nodes: the site frame itself, on which answers in that frame hang
  std::vector<std::string> control;  // points whose coordinates took part, ascending; empty: not tied
};

// `adjusted`: the graph as it was solved, with the coordinates that took part; plus `offset` it is in the site frame.
ControlledGraph MakeControlledGraph(BlockGraph adjusted, const Eigen::Vector2d& offset);

}  // namespace survey
