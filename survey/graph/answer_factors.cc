// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/answer_factors.h"

#include <algorithm>

namespace survey {
namespace {

constexpr double kChiSquare3 = 14.16;  // 99.73 %, three degrees of freedom

// What odometry alone gets wrong over a rejected stretch.
constexpr double kRejectedSigma_m = 1.0;
constexpr double kRejectedSigma_rad = 0.3;

const Pose2& Tracked(const Track& track, ScanId scan) {
  return track.scans[static_cast<std::size_t>(scan.value)].local_from_scan;
}

// The last node at or before a scan, or the first node.
ScanId NodeNear(const BlockGraph& block, ScanId scan) {
  const auto after = std::upper_bound(block.nodes.begin(), block.nodes.end(), scan);
  return after == block.nodes.begin() ? *after : *(after - 1);
}

ScanId NodeOfPose(const BlockGraph& block, int pose) {
  return block.nodes[static_cast<std::size_t>(pose) - block.num_submaps];
}

// A node behind the begin of the stretch in a submap that was begun before.
bool SpansStretch(const PoseEdge& edge, const Track& track, const BlockGraph& block, const Answer& stretch) {
  const auto num_submaps = static_cast<int>(block.num_submaps);
  if (edge.robust || edge.base >= num_submaps || edge.target < num_submaps) return false;
  const Submap& submap = track.submaps[static_cast<std::size_t>(edge.base)];
  return submap.nodes.front() < stretch.scan && !(NodeOfPose(block, edge.target) < stretch.scan);
}

bool MovesInStretch(const PoseEdge& edge, const BlockGraph& block, const Answer& stretch) {
  const auto num_submaps = static_cast<int>(block.num_submaps);
  if (edge.robust || edge.base < num_submaps || edge.target < num_submaps) return false;
  return !(NodeOfPose(block, edge.target) < stretch.scan) && !(stretch.end < NodeOfPose(block, edge.base));
}

// The many nodes of a submap would together hold what each of them holds weakly, so those that span the stretch are let
// go; the motions in it stay, with the sigmas of odometry.
void RejectStretch(const Track& track, const Answer& stretch, BlockGraph* block) {
  std::erase_if(block->graph.edges, [&](const PoseEdge& edge) { return SpansStretch(edge, track, *block, stretch); });
  const Eigen::Vector3d sigma(kRejectedSigma_m, kRejectedSigma_m, kRejectedSigma_rad);
  for (PoseEdge& edge : block->graph.edges) {
    if (MovesInStretch(edge, *block, stretch)) edge.covariance.diagonal() += sigma.cwiseAbs2();
  }
}

PoseEdge EdgeOf(const Track& track, const Answer& answer, const BlockGraph& block) {
  const ScanId base = NodeNear(block, answer.reference);
  const ScanId target = NodeNear(block, answer.scan);
  const Pose2 base_from_reference = Between(Tracked(track, base), Tracked(track, answer.reference));
  const Pose2 scan_from_target = Between(Tracked(track, answer.scan), Tracked(track, target));
  const Eigen::Matrix3d covariance = answer.sigma.cwiseAbs2().asDiagonal();
  return {block.PoseOf(base),
          block.PoseOf(target),
          base_from_reference * answer.reference_from_scan * scan_from_target,
          RotatedCovariance(covariance, base_from_reference.theta),
          false,
          EdgeKind::kAnswer};
}

}  // namespace

std::size_t AddAnswers(const Track& track, const Answers& answers, BlockGraph* block) {
  for (const Answer& answer : answers) {
    if (answer.decision == Decision::kRejectStretch) RejectStretch(track, answer, block);
  }
  const std::size_t first = block->graph.edges.size();
  for (const Answer& answer : answers) {
    if (answer.HasPose()) block->graph.edges.push_back(EdgeOf(track, answer, *block));
  }
  return first;
}

std::vector<AnswerTest> TestAnswers(const Answers& answers, const BlockGraph& block, std::size_t first_edge) {
  std::vector<AnswerTest> tests;
  for (const Answer& answer : answers) {
    if (!answer.HasPose()) continue;
    const double chi_square =
        SquaredNormalisedResidual(block.graph.edges[first_edge + tests.size()], block.graph.poses);
    tests.push_back({answer.name, answer.scan, chi_square, chi_square > kChiSquare3});
  }
  return tests;
}

}  // namespace survey
