// SPDX-License-Identifier: Apache-2.0
//
// Loop closures in worlds that look alike in several places, with known truth.
#include "survey/graph/loop_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "survey/graph/block_graph.h"
#include "survey/graph/loop_consistency.h"
#include "survey/graph/loop_ways.h"
#include "survey/submaps/tracker.h"
#include "tests/support/room.h"

namespace survey {
namespace {

using test_support::Outline;
using test_support::Wall;

void Append(const std::vector<Wall>& more, std::vector<Wall>* walls) {
  walls->insert(walls->end(), more.begin(), more.end());
}

// Walks along the corners, turning on the spot.
std::vector<Pose2> Walk(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Pose2> poses;
  double heading = 0.0;
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const Eigen::Vector2d way = corners[k] - corners[k - 1];
    const double next = std::atan2(way.y(), way.x());
    const double turn = poses.empty() ? 0.0 : NormalizeAngle(next - heading);
    const int turns = static_cast<int>(std::abs(turn) / 0.1);
    for (int i = 1; i <= turns; ++i)
      poses.push_back({corners[k - 1].x(), corners[k - 1].y(), NormalizeAngle(heading + turn * i / (turns + 1))});
    heading = next;
    const int steps = static_cast<int>(way.norm() / 0.1);
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d p = corners[k - 1] + way * (static_cast<double>(i) / steps);
      poses.push_back({p.x(), p.y(), heading});
    }
  }
  return poses;
}

struct Closed {
  int accepted = 0;
  int searched = 0;
  double largest_error_m = 0.0;  // of the accepted ones, against the truth
};

Closed CloseLoops(const std::vector<Wall>& walls, const std::vector<Pose2>& truth, const LoopOptions& options) {
  const Session session = test_support::SimulateSession(walls, truth, 10.0, 0.01, 1.02, 0.005);
  const Track track = TrackBlock(session, {});
  const Loops loops = FindLoops(session, track, options);
  Closed closed{.searched = loops.candidates_searched};
  for (const Loop& loop : loops.loops) {
    if (!loop.accepted) continue;
    ++closed.accepted;
    const Submap& submap = track.submaps[static_cast<std::size_t>(loop.constraint.submap.value)];
    const auto first = static_cast<std::size_t>(submap.nodes.front().value);
    const Pose2 by_truth = Between(submap.local_from_submap, track.scans[first].local_from_scan) *
                           Between(truth[first], truth[static_cast<std::size_t>(loop.constraint.scan.value)]);
    const double error = (by_truth.Translation() - loop.constraint.submap_from_scan.Translation()).norm();
    closed.largest_error_m = std::max(closed.largest_error_m, error);
  }
  return closed;
}

// Two corridors of 30 m side by side, each with the same niches every 5 m, joined at one end.
std::vector<Wall> TwinCorridors() {
  std::vector<Wall> walls;
  std::vector<Eigen::Vector2d> hall = {{0, 0}};
  for (int i = 0; i < 6; ++i) {
    const double x = 2.0 + 5.0 * i;
    for (const auto& corner : {Eigen::Vector2d{x, 0}, {x, -0.6}, {x + 1.2, -0.6}, {x + 1.2, 0}}) hall.push_back(corner);
  }
  for (const auto& corner : {Eigen::Vector2d{34, 0}, {34, 7}, {0, 7}, {0, 5}, {32, 5}, {32, 2}, {0, 2}})
    hall.push_back(corner);
  Append(Outline(hall), &walls);
  return walls;
}

TEST(LoopSearch, CorridorsThatLookAlikeAreNotTakenForEachOther) {
  const Closed closed = CloseLoops(TwinCorridors(), Walk({{0.8, 1}, {33, 1}, {33, 6}, {0.8, 6}}), {});
  EXPECT_GT(closed.searched, 0);
  EXPECT_LT(closed.largest_error_m, 0.2);
}

// Two rooms, equal to the centimetre, off a corridor; both symmetric about their axis.
std::vector<Wall> TwinRooms() {
  std::vector<Wall> walls = Outline({{0, 0},  {24, 0},   {24, 3},     {19.5, 3},  {19.5, 3.2}, {22, 3.2},  {22, 9},
                                     {16, 9}, {16, 3.2}, {18.5, 3.2}, {18.5, 3},  {5.5, 3},    {5.5, 3.2}, {8, 3.2},
                                     {8, 9},  {2, 9},    {2, 3.2},    {4.5, 3.2}, {4.5, 3},    {0, 3}});
  for (const double x : {3.5, 6.0, 17.5, 20.0})
    Append(Outline({{x, 6}, {x + 0.5, 6}, {x + 0.5, 6.5}, {x, 6.5}}), &walls);
  return walls;
}

const std::vector<Eigen::Vector2d> kBothRooms = {{1, 1.5},  {5, 1.5},  {5, 7.5},  {5, 1.5},
                                                 {19, 1.5}, {19, 7.5}, {19, 1.5}, {1, 1.5}};

TEST(LoopSearch, SymmetricRoomsThatAreEqualAreNotTakenForEachOther) {
  const Closed closed = CloseLoops(TwinRooms(), Walk(kBothRooms), {});
  EXPECT_GT(closed.accepted, 5);  // on the way back
  EXPECT_LT(closed.largest_error_m, 0.15);
}

TEST(LoopSearch, AFewNodesPerSubmapCloseTheSameLoops) {
  LoopOptions options;
  options.max_nodes_per_submap = 4;
  const Closed all = CloseLoops(TwinRooms(), Walk(kBothRooms), {});
  const Closed few = CloseLoops(TwinRooms(), Walk(kBothRooms), options);
  EXPECT_LT(few.searched, all.searched);
  EXPECT_GT(few.accepted, 3);
  EXPECT_LT(few.largest_error_m, 0.15);
}

TEST(LoopSearch, ScansOfTooFewPointsAreNotLoops) {
  LoopOptions options;
  options.place.min_points = options.place.max_points + 1;
  EXPECT_EQ(CloseLoops(TwinRooms(), Walk(kBothRooms), options).accepted, 0);
}

// From `first` to `last` the track went blind, if it knows, and missed a turn and a way.
Track WithFault(const Track& track, std::size_t first, std::size_t last, bool known) {
  Track faulty = track;
  const Pose2 at = track.scans[first].local_from_scan;
  const Pose2 shift = at * Pose2{1.2, 1.2, 0.05} * Inverse(at);
  for (std::size_t i = first; i < track.scans.size(); ++i) {
    TrackedScan& scan = faulty.scans[i];
    if (i >= last) scan.local_from_scan = shift * scan.local_from_scan;
    if (i >= last || !known) continue;
    scan.matched = false;
    scan.prediction = Prediction::kOdometry;
    scan.covariance = Eigen::Vector3d(1.8e-3, 1.8e-3, 2e-4).asDiagonal();
  }
  for (SubmapConstraint& constraint : faulty.constraints) {
    const Submap& submap = faulty.submaps[static_cast<std::size_t>(constraint.submap.value)];
    const auto scan = static_cast<std::size_t>(constraint.scan.value);
    constraint.submap_from_scan = Between(submap.local_from_submap, faulty.scans[scan].local_from_scan);
  }
  return faulty;
}

TEST(LoopSearch, BehindABlindStretchItSearchesAsFarAsOdometryMayHaveGone) {
  const std::vector<Pose2> truth = Walk(kBothRooms);
  const Session session = test_support::SimulateSession(TwinRooms(), truth, 10.0, 0.01, 1.02, 0.005);
  const Track track = TrackBlock(session, {});
  const auto end_error = [&](bool known) {
    const Track faulty = WithFault(track, 270, 330, known);
    BlockGraph block = MakeBlockGraph(faulty, FindLoops(session, faulty, {}));
    EXPECT_TRUE(Solve(&block.graph, {.chordal_start = true}).usable);
    const Pose2 motion = Between(block.graph.poses[block.num_submaps], block.graph.poses.back());
    return (motion.Translation() - Between(truth.front(), truth.back()).Translation()).norm();
  };
  EXPECT_GT(end_error(false), 1.0);
  EXPECT_LT(end_error(true), 0.2);
}

TEST(LoopConsistency, TheMinorityThatContradictsIsRejectedAndSoIsALoner) {
  std::vector<Loop> loops;
  std::vector<double> way;
  std::vector<Pose2> track;
  for (int i = 0; i < 9; ++i) {
    const double along = i < 8 ? 2.0 * i : 200.0;  // the last one is far from all others
    const double shift = i == 2 || i == 5 ? 3.0 : 0.0;
    Loop loop;
    loop.constraint.submap_from_scan = {along + shift, 1.0, 0.0};
    loop.constraint.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    loops.push_back(loop);
    way.push_back(along);
    track.push_back({10.0, 20.0 + along, std::numbers::pi / 2});
  }
  KeepMutuallyConsistent(way, track, {}, &loops);
  for (const int i : {0, 1, 3, 4, 6, 7}) EXPECT_TRUE(loops[static_cast<std::size_t>(i)].accepted) << i;
  EXPECT_EQ(loops[2].reason, "contradicts its neighbours");
  EXPECT_EQ(loops[5].reason, "contradicts its neighbours");
  EXPECT_EQ(loops[8].reason, "no neighbour agrees");
}

TEST(LoopWays, AClosedLoopShortensTheWay) {
  Track track;
  for (int i = 0; i < 100; ++i) {
    const ScanId scan{i};
    track.scans.push_back({.scan = scan, .local_from_scan = {1.0 * i, 0, 0}, .is_node = true});
    if (i % 20 == 0) track.submaps.push_back({SubmapId{i / 20}, {1.0 * i, 0, 0}, {}});
    track.submaps.back().nodes.push_back(scan);
    track.constraints.push_back({track.submaps.back().id, scan, {1.0 * (i % 20), 0, 0}});
  }
  const BlockGraph block = MakeBlockGraph(track);
  std::vector<double> along;
  for (int i = 0; i < 100; ++i) along.push_back(i);
  LoopWays ways(track, block, along);
  EXPECT_NEAR(ways.From(SubmapId{0})[90], 80.0, 1e-9);  // from the submap's middle, node 10
  ways.Close(95, SubmapId{0});
  EXPECT_NEAR(ways.From(SubmapId{0})[90], 6.0, 1e-9);
}

}  // namespace
}  // namespace survey
