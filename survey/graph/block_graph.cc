// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_graph.h"

#include <algorithm>
#include <map>

namespace survey {

int BlockGraph::PoseOf(ScanId node) const {
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), node);
  return static_cast<int>(num_submaps) + static_cast<int>(found - nodes.begin());
}

bool GoneBlind(const TrackedScan& scan) {
  return !scan.matched &&
         (scan.prediction == Prediction::kOdometry || scan.prediction == Prediction::kConstantVelocity);
}

namespace {

// For each scan the number of blind stretches of more than a metre before it; -1 where it has no match itself.
std::vector<int> PiecesBetweenBlindStretches(const Track& track) {
  constexpr double kLongestBlind_m = 1.0;
  std::vector<int> pieces;
  int piece = 0;
  double blind_m = 0.0;
  for (const TrackedScan& scan : track.scans) {
    if (GoneBlind(scan)) {
      const Pose2& before = track.scans[pieces.empty() ? 0 : pieces.size() - 1].local_from_scan;
      blind_m += (scan.local_from_scan.Translation() - before.Translation()).norm();
      pieces.push_back(-1);
      continue;
    }
    if (blind_m > kLongestBlind_m) ++piece;
    blind_m = 0.0;
    pieces.push_back(piece);
  }
  return pieces;
}

// A submap is rigid where matches hold it together. Of one that a blind stretch cuts the piece with the most nodes
// stays; the motions hold the others. One without any match stays with its first node.
std::vector<SubmapConstraint> HeldMemberships(const Track& track, const std::vector<SubmapConstraint>& memberships) {
  const std::vector<int> pieces = PiecesBetweenBlindStretches(track);
  const auto piece_of = [&](const SubmapConstraint& each) { return pieces[static_cast<std::size_t>(each.scan.value)]; };
  std::vector<std::map<int, int>> counts(track.submaps.size());
  std::vector<ScanId> first(track.submaps.size());
  for (const SubmapConstraint& each : memberships) {
    ScanId& of_submap = first[static_cast<std::size_t>(each.submap.value)];
    if (of_submap.value < 0) of_submap = each.scan;
    if (piece_of(each) >= 0) ++counts[static_cast<std::size_t>(each.submap.value)][piece_of(each)];
  }
  std::vector<SubmapConstraint> held;
  for (const SubmapConstraint& each : memberships) {
    const std::map<int, int>& nodes = counts[static_cast<std::size_t>(each.submap.value)];
    const auto largest =
        std::max_element(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const bool held_here = nodes.empty() ? each.scan == first[static_cast<std::size_t>(each.submap.value)]
                                         : piece_of(each) == largest->first;
    if (held_here) held.push_back(each);
  }
  return held;
}

// [CN] eq. (10) for the nodes in the submaps that they helped to draw. The errors of all nodes of a submap stem from
// the same drawing and are far from independent: together they weigh as much as a few independent ones.
void AddMemberships(const Track& track, BlockGraph* block) {
  constexpr double kIndependentNodes = 2.0;
  std::vector<SubmapConstraint> memberships = track.constraints;
  std::erase_if(memberships, [&](const SubmapConstraint& constraint) {
    return !std::binary_search(block->nodes.begin(), block->nodes.end(), constraint.scan);
  });
  memberships = HeldMemberships(track, memberships);
  std::vector<int> count(track.submaps.size(), 0);
  for (const SubmapConstraint& constraint : memberships) ++count[static_cast<std::size_t>(constraint.submap.value)];
  for (const SubmapConstraint& constraint : memberships) {
    const double nodes = count[static_cast<std::size_t>(constraint.submap.value)];
    block->graph.edges.push_back({block->PoseOf(constraint.submap), block->PoseOf(constraint.scan),
                                  constraint.submap_from_scan,
                                  constraint.covariance * std::max(1.0, nodes / kIndependentNodes), false});
  }
}

// Whether the motion from one node to the next lies in a blind stretch, by the pieces.
class BlindMotions {
 public:
  explicit BlindMotions(const std::vector<int>& pieces) : before_(pieces), behind_(pieces) {
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      if (before_[i] < 0) before_[i] = before_[i - 1];
      const std::size_t j = pieces.size() - 1 - i;
      if (behind_[j] < 0) behind_[j] = behind_[j + 1];
    }
  }
  bool Between(ScanId from, ScanId to) const {
    return before_[static_cast<std::size_t>(from.value)] != behind_[static_cast<std::size_t>(to.value)];
  }

 private:
  std::vector<int> before_;  // piece of the last scan with a match up to each
  std::vector<int> behind_;  // and of the first one from it on
};

// How far the first match behind a blind scan lies from where the platform was going.
Eigen::Vector3d JumpTo(const Track& track, ScanId matched) {
  const auto pose = [&](int scan) { return track.scans[static_cast<std::size_t>(scan)].local_from_scan; };
  const int scan = matched.value;
  if (scan < 2) return Eigen::Vector3d::Zero();
  const Pose2 expected = pose(scan - 1) * Between(pose(scan - 2), pose(scan - 1));
  const Pose2 jump = Between(expected, pose(scan));
  return {jump.Translation().norm(), jump.Translation().norm(), jump.theta};
}

// A match tells where its own scan lies, a blind prediction the motion from the scan before.
Eigen::Matrix3d CovarianceOfMotion(const TrackedScan& from, const TrackedScan& to, double way) {
  Eigen::Matrix3d covariance = to.covariance;
  if (!GoneBlind(from)) covariance += from.covariance;
  covariance.diagonal() += Eigen::Vector3d(1e-5 + 1e-4 * way, 1e-5 + 1e-4 * way, 1e-6 + 1e-5 * way);
  return covariance;
}

// The motion from node to node as the track has it: keeps the shape of the trajectory when something pulls at one node.
// Where the track found itself again behind a blind stretch, the jump is as uncertain as it is large.
void AddMotions(const Track& track, BlockGraph* block) {
  const BlindMotions blind(PiecesBetweenBlindStretches(track));
  for (std::size_t n = 1; n < block->nodes.size(); ++n) {
    const TrackedScan& from = track.scans[static_cast<std::size_t>(block->nodes[n - 1].value)];
    const TrackedScan& to = track.scans[static_cast<std::size_t>(block->nodes[n].value)];
    const Pose2 motion = Between(from.local_from_scan, to.local_from_scan);
    Eigen::Matrix3d covariance = CovarianceOfMotion(from, to, motion.Translation().norm());
    const bool in_blind = blind.Between(from.scan, to.scan);
    if (in_blind && !GoneBlind(to)) covariance.diagonal() += JumpTo(track, to.scan).cwiseAbs2();
    const int base = static_cast<int>(block->num_submaps + n);
    block->graph.edges.push_back({base - 1, base, motion, RotatedCovariance(covariance, -from.local_from_scan.theta),
                                  false, EdgeKind::kMotion, in_blind});
  }
}

}  // namespace

ScanId NodeNear(const BlockGraph& block, ScanId scan) {
  const auto after = std::upper_bound(block.nodes.begin(), block.nodes.end(), scan);
  return after == block.nodes.begin() ? *after : *(after - 1);
}

BlockGraph MakeBlockGraph(const Track& track) {
  std::vector<ScanId> nodes;
  for (const TrackedScan& scan : track.scans) {
    if (scan.is_node) nodes.push_back(scan.scan);
  }
  return MakeBlockGraph(track, nodes);
}

BlockGraph MakeBlockGraph(const Track& track, const std::vector<ScanId>& nodes) {
  BlockGraph block;
  block.nodes = nodes;
  block.num_submaps = track.submaps.size();
  for (const Submap& submap : track.submaps) block.graph.poses.push_back(submap.local_from_submap);
  for (const ScanId node : nodes)
    block.graph.poses.push_back(track.scans[static_cast<std::size_t>(node.value)].local_from_scan);
  AddMemberships(track, &block);
  AddMotions(track, &block);
  for (const TrackedMark& mark : track.marks) block.point_names.push_back(mark.point);
  std::sort(block.point_names.begin(), block.point_names.end());
  block.point_names.erase(std::unique(block.point_names.begin(), block.point_names.end()), block.point_names.end());
  block.graph.points.resize(block.point_names.size());
  for (const TrackedMark& mark : track.marks) {
    const auto name = std::lower_bound(block.point_names.begin(), block.point_names.end(), mark.point);
    const int point = static_cast<int>(name - block.point_names.begin());
    const int pose = block.PoseOf(mark.scan);
    block.graph.marks.push_back({pose, point, mark.mark_in_scan, mark.covariance});
    block.graph.points[static_cast<std::size_t>(point)] =
        block.graph.poses[static_cast<std::size_t>(pose)] * mark.mark_in_scan;
  }
  block.graph.fixed_pose = 0;
  return block;
}

BlockGraph MakeBlockGraph(const Track& track, const Loops& loops) {
  BlockGraph block = MakeBlockGraph(track);
  for (const Loop& loop : loops.loops) {
    if (loop.accepted) AddLoop(loop.constraint, &block);
  }
  return block;
}

void AddLoop(const SubmapConstraint& loop, BlockGraph* block) {
  block->graph.edges.push_back({block->PoseOf(loop.submap), block->PoseOf(loop.scan), loop.submap_from_scan,
                                loop.covariance, true, EdgeKind::kLoop});
}

std::vector<Pose2> PosesOfAllScans(const Track& track, const BlockGraph& block, const std::vector<StampNs>& stamps) {
  std::vector<Pose2> poses;
  poses.reserve(track.scans.size());
  const auto moved = [&](std::size_t node, std::size_t scan) {
    const std::size_t node_scan = static_cast<std::size_t>(block.nodes[node].value);
    return block.graph.poses[block.num_submaps + node] *
           Between(track.scans[node_scan].local_from_scan, track.scans[scan].local_from_scan);
  };
  std::size_t next = 0;  // first node at or after the scan
  for (std::size_t i = 0; i < track.scans.size(); ++i) {
    while (next < block.nodes.size() && static_cast<std::size_t>(block.nodes[next].value) < i) ++next;
    if (next == 0 || (next < block.nodes.size() && static_cast<std::size_t>(block.nodes[next].value) == i)) {
      poses.push_back(moved(next, i));
    } else if (next == block.nodes.size()) {
      poses.push_back(moved(next - 1, i));
    } else {
      const StampNs before = stamps[static_cast<std::size_t>(block.nodes[next - 1].value)];
      const StampNs after = stamps[static_cast<std::size_t>(block.nodes[next].value)];
      const double fraction =
          after > before ? static_cast<double>(stamps[i] - before) / static_cast<double>(after - before) : 0.5;
      poses.push_back(Interpolate(moved(next - 1, i), moved(next, i), fraction));
    }
  }
  return poses;
}

}  // namespace survey
