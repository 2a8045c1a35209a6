// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/trajectory_tree.h"

#include <algorithm>

namespace survey {

Pose2 PoseOfAncestor(const TrajectoryTree& tree, std::size_t particle, std::size_t update) {
  for (std::size_t k = tree.size() - 1; k > update; --k) particle = static_cast<std::size_t>(tree[k].parents[particle]);
  return tree[update].poses[particle];
}

std::vector<Pose2> BestTrajectory(const TrajectoryTree& tree) {
  std::vector<Pose2> poses(tree.size());
  if (tree.empty()) return poses;
  const std::vector<double>& evidence = tree.back().evidence;
  auto particle = static_cast<std::size_t>(std::max_element(evidence.begin(), evidence.end()) - evidence.begin());
  for (std::size_t k = tree.size(); k-- > 0;) {
    poses[k] = tree[k].poses[particle];
    particle = static_cast<std::size_t>(tree[k].parents[particle]);
  }
  return poses;
}

}  // namespace survey
