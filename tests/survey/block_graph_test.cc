// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace survey {
namespace {

// A walk around a circle of 20 m, one scan a metre, submaps of 20 nodes that overlap by half. The headings of the track
// drift by `drift_rad` in all, so that it does not meet its start again.
Track CircleWithDrift(double drift_rad) {
  constexpr int kScans = 126;
  Track track;
  Pose2 pose;
  for (int i = 0; i < kScans; ++i) {
    const ScanId scan{i};
    track.scans.push_back({.scan = scan,
                           .local_from_scan = pose,
                           .covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal(),
                           .is_node = true});
    if (i % 10 == 0) track.submaps.push_back({SubmapId{i / 10}, {pose.x, pose.y, 0.0}, {}});
    const std::size_t newest = track.submaps.size() - 1;
    for (std::size_t s = newest > 0 ? newest - 1 : 0; s <= newest; ++s) {
      Submap& submap = track.submaps[s];
      submap.nodes.push_back(scan);
      track.constraints.push_back(
          {submap.id, scan, Between(submap.local_from_submap, pose), Eigen::Vector3d(1e-4, 1e-4, 4e-6).asDiagonal()});
    }
    pose = pose * Pose2{1.0, 0.0, (2.0 * std::numbers::pi + drift_rad) / (kScans - 1)};
  }
  for (const int i : {0, kScans - 1}) {
    track.marks.push_back({"P1", 0, 1, ScanId{i}, Eigen::Vector2d::Zero(), 1e-6 * Eigen::Matrix2d::Identity()});
  }
  return track;
}

double Misclosure(const BlockGraph& block) {
  return (block.graph.poses.back().Translation() - block.graph.poses[block.num_submaps].Translation()).norm();
}

TEST(BlockGraph, TwoVisitsToOnePointCloseTheTourWithoutItsCoordinates) {
  BlockGraph block = MakeBlockGraph(CircleWithDrift(0.05));
  EXPECT_GT(Misclosure(block), 0.4);
  ASSERT_TRUE(Solve(&block.graph, {}).usable);
  EXPECT_LT(Misclosure(block), 0.01);
}

TEST(BlockGraph, AFewOfTheNodesBendAsAllDo) {
  const Track track = CircleWithDrift(0.05);
  BlockGraph all = MakeBlockGraph(track);
  std::vector<ScanId> few;
  for (const ScanId node : all.nodes) {
    if (node.value % 5 == 0) few.push_back(node);
  }
  BlockGraph coarse = MakeBlockGraph(track, few);
  EXPECT_EQ(coarse.nodes, few);
  Solve(&all.graph, {});
  Solve(&coarse.graph, {});
  for (const ScanId node : few) {
    const Pose2& fine = all.graph.poses[static_cast<std::size_t>(all.PoseOf(node))];
    const Pose2& bent = coarse.graph.poses[static_cast<std::size_t>(coarse.PoseOf(node))];
    EXPECT_LT((fine.Translation() - bent.Translation()).norm(), 0.05) << node.value;
  }
}

TEST(BlockGraph, BlindMotionsAreMarkedAndAJumpBehindThemIsAsUncertainAsItIsLarge) {
  Track track = CircleWithDrift(0.0);
  track.marks.clear();
  for (std::size_t i = 0; i < track.scans.size(); ++i) {
    track.scans[i].matched = i < 40 || i >= 50;
    track.scans[i].prediction = Prediction::kOdometry;
  }
  const Pose2 at = track.scans[49].local_from_scan;
  for (std::size_t i = 50; i < track.scans.size(); ++i) {
    Pose2& pose = track.scans[i].local_from_scan;
    pose = at * Pose2{2.0, 0.0, 0.4} * Between(at, pose);
  }
  const BlockGraph block = MakeBlockGraph(track);
  const auto motion_to = [&](int node) {
    return *std::find_if(block.graph.edges.begin(), block.graph.edges.end(), [&](const PoseEdge& edge) {
      return edge.kind == EdgeKind::kMotion && edge.target == block.PoseOf(ScanId{node});
    });
  };
  for (const int node : {39, 51}) EXPECT_FALSE(motion_to(node).blind) << node;
  for (const int node : {40, 45, 50}) EXPECT_TRUE(motion_to(node).blind) << node;
  EXPECT_LT(motion_to(45).covariance(0, 0), 0.01);
  EXPECT_NEAR(std::sqrt(motion_to(50).covariance(0, 0)), 2.0, 0.3);
  EXPECT_NEAR(std::sqrt(motion_to(50).covariance(2, 2)), 0.4, 0.05);
}

}  // namespace
}  // namespace survey
