// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/controlled_graph.h"

#include <algorithm>

namespace survey {
namespace {

void Shift(const Eigen::Vector2d& shift, PoseGraph* graph) {
  for (Pose2& pose : graph->poses) pose = {pose.x + shift.x(), pose.y + shift.y(), pose.theta};
  for (Eigen::Vector2d& point : graph->points) point += shift;
}

// The adjustment had its own origin, `offset` from the site's and with the same axes.
void HangOnSite(int origin, const Eigen::Vector2d& offset, PoseGraph* graph) {
  graph->poses[static_cast<std::size_t>(origin)] = {};
  for (PoseEdge& edge : graph->edges) {
    if (edge.base != origin) continue;
    edge.base_from_target.x += offset.x();
    edge.base_from_target.y += offset.y();
  }
}

}  // namespace

ControlledGraph MakeControlledGraph(BlockGraph adjusted, const Eigen::Vector2d& offset) {
  ControlledGraph result{.block = std::move(adjusted), .site_pose = {}, .control = {}};
  PoseGraph& graph = result.block.graph;
  const std::size_t first_other = result.block.num_submaps + result.block.nodes.size();
  for (const GivenCoordinates& given : graph.given) {
    for (const int point : given.points)
      result.control.push_back(result.block.point_names[static_cast<std::size_t>(point)]);
  }
  std::sort(result.control.begin(), result.control.end());
  graph.given.clear();
  graph.fixed_pose.reset();
  Shift(offset, &graph);
  if (graph.poses.size() > first_other) {
    result.site_pose = static_cast<int>(first_other);
    HangOnSite(*result.site_pose, offset, &graph);
  }
  return result;
}

}  // namespace survey
