// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/controlled_graph.h"

#include <algorithm>

namespace survey {

void Shift(const Eigen::Vector2d& shift, PoseGraph* graph) {
  for (Pose2& pose : graph->poses) pose = {pose.x + shift.x(), pose.y + shift.y(), pose.theta};
  for (Eigen::Vector2d& point : graph->points) point += shift;
}

ControlledGraph MakeControlledGraph(BlockGraph adjusted, const Eigen::Vector2d& offset) {
  ControlledGraph result{.block = std::move(adjusted), .control = {}};
  PoseGraph& graph = result.block.graph;
  for (const GivenCoordinates& given : graph.given) {
    for (const int point : given.points)
      result.control.push_back(result.block.point_names[static_cast<std::size_t>(point)]);
  }
  std::sort(result.control.begin(), result.control.end());
  graph.given.clear();
  graph.fixed_pose.reset();
  Shift(offset, &graph);
  return result;
}

}  // namespace survey
