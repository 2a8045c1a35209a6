// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/loop_ways.h"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace survey {
namespace {

constexpr double kLoopLength_m = 1.0;

}  // namespace

LoopWays::LoopWays(const Track& track, const BlockGraph& block, const std::vector<double>& way_along)
    : num_nodes_(block.nodes.size()), arcs_(block.nodes.size() + track.submaps.size()) {
  for (std::size_t n = 1; n < num_nodes_; ++n) Connect(n - 1, n, way_along[n] - way_along[n - 1]);
  // A node hangs on its submap by the way to the submap's middle.
  std::vector<std::vector<std::size_t>> members(track.submaps.size());
  for (const PoseEdge& edge : block.graph.edges) {
    const auto base = static_cast<std::size_t>(edge.base);
    if (!edge.robust && base < track.submaps.size())
      members[base].push_back(static_cast<std::size_t>(edge.target) - block.num_submaps);
  }
  for (std::size_t s = 0; s < members.size(); ++s) {
    if (members[s].empty()) continue;
    const double middle = way_along[members[s][members[s].size() / 2]];
    for (const std::size_t n : members[s]) Connect(n, num_nodes_ + s, std::abs(way_along[n] - middle));
  }
}

void LoopWays::Close(int node, SubmapId submap) {
  Connect(static_cast<std::size_t>(node), num_nodes_ + static_cast<std::size_t>(submap.value), kLoopLength_m);
}

void LoopWays::Connect(std::size_t a, std::size_t b, double length) {
  arcs_[a].push_back({b, length});
  arcs_[b].push_back({a, length});
}

std::vector<double> LoopWays::From(SubmapId submap) const {
  const std::size_t start = num_nodes_ + static_cast<std::size_t>(submap.value);
  std::vector<double> ways(arcs_.size(), std::numeric_limits<double>::max());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  ways[start] = 0.0;
  queue.emplace(0.0, start);
  while (!queue.empty()) {
    const auto [way, vertex] = queue.top();
    queue.pop();
    if (way > ways[vertex]) continue;
    for (const Arc& arc : arcs_[vertex]) {
      if (way + arc.length >= ways[arc.to]) continue;
      ways[arc.to] = way + arc.length;
      queue.emplace(ways[arc.to], arc.to);
    }
  }
  ways.resize(num_nodes_);
  return ways;
}

}  // namespace survey
