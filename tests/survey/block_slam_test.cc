// SPDX-License-Identifier: Apache-2.0
//
// The front end, the loop search and the block adjustment together on small simulated worlds with known truth.
#include <gtest/gtest.h>

#include <cmath>

#include "survey/geometry/rigid_fit.h"
#include "survey/graph/block_adjustment.h"
#include "survey/graph/loop_search.h"
#include "survey/stats/philox.h"
#include "survey/submaps/block_raster.h"
#include "survey/submaps/tracker.h"
#include "tests/support/room.h"

namespace survey {
namespace {

double RmsAfterRigidFit(const std::vector<Pose2>& estimated, const std::vector<Pose2>& truth) {
  std::vector<Eigen::Vector2d> a;
  std::vector<Eigen::Vector2d> b;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    a.push_back(estimated[i].Translation());
    b.push_back(truth[i].Translation());
  }
  return FitRigid(a, b)->rms_m;
}

struct RingWalk : public testing::Test {
  static void SetUpTestSuite() {
    truth = new std::vector<Pose2>(test_support::LapsOfTheRing(2));
    session = new Session(test_support::SimulateSession(test_support::Ring(), *truth, 10.0, 0.01, 1.03, 0.01));
    track = new Track(TrackBlock(*session, {}));
  }
  static void TearDownTestSuite() {
    delete truth;
    delete session;
    delete track;
  }
  static std::vector<StampNs> Stamps() {
    std::vector<StampNs> stamps;
    for (const Scan& scan : session->scans) stamps.push_back(scan.stamp_ns);
    return stamps;
  }
  static std::vector<Pose2> Poses(const Solution& solution) {
    std::vector<Pose2> poses;
    for (const SolvedScan& scan : solution.scans) poses.push_back(scan.site_from_scan);
    return poses;
  }
  static std::vector<Pose2>* truth;
  static Session* session;
  static Track* track;
};
std::vector<Pose2>* RingWalk::truth = nullptr;
Session* RingWalk::session = nullptr;
Track* RingWalk::track = nullptr;

TEST_F(RingWalk, TrackFollowsWhereOdometryDrifts) {
  std::vector<Pose2> tracked;
  for (const TrackedScan& scan : track->scans) tracked.push_back(scan.local_from_scan);
  EXPECT_LT(RmsAfterRigidFit(tracked, *truth), 0.10);
  std::vector<Pose2> odometry;
  for (const OdometrySample& sample : session->odometry) odometry.push_back(sample.odom_from_body);
  EXPECT_GT(RmsAfterRigidFit(odometry, *truth), 1.0);
}

TEST_F(RingWalk, TrackWorksWithoutOdometry) {
  Session blind = *session;
  blind.odometry.clear();
  const Track lost = TrackBlock(blind, {});
  std::vector<Pose2> tracked;
  for (const TrackedScan& scan : lost.scans) tracked.push_back(scan.local_from_scan);
  EXPECT_LT(RmsAfterRigidFit(tracked, *truth), 0.20);
  EXPECT_EQ(lost.scans.back().prediction, Prediction::kConstantVelocity);
}

// Scans [begin, end) are missing, and the wheels tell nothing of the motion between them.
Session WithDeniedMotion(Session session, std::vector<Pose2>* truth, std::ptrdiff_t begin, std::ptrdiff_t end) {
  const Pose2 before = session.odometry[static_cast<std::size_t>(begin - 1)].odom_from_body;
  const Pose2 behind = session.odometry[static_cast<std::size_t>(end)].odom_from_body;
  for (std::size_t i = static_cast<std::size_t>(begin); i < session.odometry.size(); ++i) {
    Pose2& pose = session.odometry[i].odom_from_body;
    pose = i < static_cast<std::size_t>(end) ? before : before * Between(behind, pose);
  }
  session.scans.erase(session.scans.begin() + begin, session.scans.begin() + end);
  truth->erase(truth->begin() + begin, truth->begin() + end);
  return session;
}

std::vector<Pose2> TrackedPoses(const Session& session) {
  std::vector<Pose2> poses;
  for (const TrackedScan& scan : TrackBlock(session, {}).scans) poses.push_back(scan.local_from_scan);
  return poses;
}

TEST_F(RingWalk, ATurnOf60DegreesThatTheOdometryDeniesIsFound) {
  std::vector<Pose2> seen = *truth;
  const Session denied = WithDeniedMotion(*session, &seen, 212, 221);
  EXPECT_LT(RmsAfterRigidFit(TrackedPoses(denied), seen), 0.10);
}

// Between two scans the platform turns by 105 degrees, of which the wheels tell nothing.
TEST(DeniedTurn, BeyondTheUsualWindowAScanThatHardlyFitsIsSearchedAtAnyHeading) {
  std::vector<Pose2> truth;
  for (int i = 0; i < 40; ++i) truth.push_back({-4.0 + 0.1 * i, -2.0 + 0.02 * i, 0.2});
  for (int i = 0; i < 40; ++i) truth.push_back({-0.1 - 0.02 * i, -1.2 + 0.05 * i, 2.03});
  const auto walls = test_support::Outline({{-6, -4}, {5, -5}, {9, 1}, {1, 6}, {-2, 2}, {-8, 3}});  // no right angles
  Session session = test_support::SimulateSession(walls, truth, 10.0, 0.01, 1.0, 0.0);
  for (std::size_t i = 40; i < truth.size(); ++i)
    session.odometry[i].odom_from_body = truth[39] * Between(truth[40], truth[i]);
  EXPECT_LT(RmsAfterRigidFit(TrackedPoses(session), truth), 0.05);
}

TEST_F(RingWalk, TrackFollowsWhereTheOdometryTurnsWithNoiseAndComesLate) {
  Session noisy = *session;
  double error_rad = 0.0;
  for (std::size_t i = 0; i < noisy.odometry.size(); ++i) {
    const std::size_t shown = i < 3 ? 0 : i - 3;  // 0.3 s
    error_rad += 0.026 * RandomStream(5, 1, static_cast<std::uint32_t>(i)).Normal(0);
    noisy.odometry[i].odom_from_body = session->odometry[shown].odom_from_body * Pose2{0.0, 0.0, error_rad};
  }
  EXPECT_LT(RmsAfterRigidFit(TrackedPoses(noisy), *truth), 0.15);
}

TEST(DrawnScans, OnlyTheFirstOfThoseAtRest) {
  std::vector<Pose2> poses(20, Pose2{1.0, 2.0, 0.5});
  for (int i = 1; i <= 5; ++i) poses.push_back({1.0 + 0.06 * i, 2.0, 0.5});
  poses.push_back({1.3, 2.0, 0.52});
  const std::vector<bool> drawn = DrawnScans(poses, 0.05);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(drawn[i], i < 8 || i >= 20) << i;
}

TEST(DrawnScans, OneForEachCellOfTheWay) {
  std::vector<Pose2> poses;
  for (int i = 0; i < 100; ++i) poses.push_back({0.02 * i, 0.0, 0.0});
  const std::vector<bool> drawn = DrawnScans(poses, 0.05);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(drawn[i], i % 3 == 0) << i;
}

TEST_F(RingWalk, LoopsCloseTheSecondLapAndAllAreTrue) {
  const Loops loops = FindLoops(*session, *track, {});
  int accepted = 0;
  for (const Loop& loop : loops.loops) {
    if (!loop.accepted) continue;
    ++accepted;
    // The submap's first node is its origin (heading zero): its true pose follows from that node's true pose.
    const Submap& submap = track->submaps[static_cast<std::size_t>(loop.constraint.submap.value)];
    const auto first = static_cast<std::size_t>(submap.nodes.front().value);
    const Pose2 submap_from_first = Between(submap.local_from_submap, track->scans[first].local_from_scan);
    const Pose2 true_submap_from_scan =
        submap_from_first * Between((*truth)[first], (*truth)[static_cast<std::size_t>(loop.constraint.scan.value)]);
    EXPECT_LT((true_submap_from_scan.Translation() - loop.constraint.submap_from_scan.Translation()).norm(), 0.15);
  }
  EXPECT_GT(accepted, 20);
  const BlockAdjustment adjusted = AdjustBlock(*track, loops, {}, Stamps(), {});
  ASSERT_TRUE(adjusted.usable);
  EXPECT_FALSE(adjusted.solution.tied);
  EXPECT_LT(RmsAfterRigidFit(Poses(adjusted.solution), *truth), 0.03);
}

// Marks where the walk turns; control is the truth moved into a grid of large numbers.
ControlNetwork MarkCorners(Session* session, const std::vector<Pose2>& truth, const Pose2& site_from_world,
                           std::vector<std::size_t> scans) {
  ControlNetwork control;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const StampNs stamp = session->scans[scans[k]].stamp_ns;
    const std::string name = "C" + std::to_string(k + 1);
    session->marks.push_back({name, stamp - 1000000, stamp + 1000000});
    ControlPoint point{.name = name};
    point.position_in_site = site_from_world * truth[scans[k]].Translation();
    point.covariance = 4e-6 * Eigen::Matrix2d::Identity();
    control.points.push_back(point);
  }
  return control;
}

TEST_F(RingWalk, ControlBringsTheBlockIntoTheSiteFrameAndCovariancesAreFinite) {
  const Pose2 site_from_world{500123.0, 5600456.0, 2.1};
  Session marked = *session;
  const ControlNetwork control = MarkCorners(&marked, *truth, site_from_world, {0, 210, 375, 600, 900});
  const Track tied_track = TrackBlock(marked, {});
  const BlockAdjustment adjusted = AdjustBlock(tied_track, {}, control, Stamps(), {});
  ASSERT_TRUE(adjusted.usable) << adjusted.message;
  const Solution& solution = adjusted.solution;
  EXPECT_TRUE(solution.tied);
  EXPECT_EQ(solution.statistics.num_control_marks, 5);
  double squares = 0.0;
  for (std::size_t i = 0; i < truth->size(); ++i) {
    squares +=
        (solution.scans[i].site_from_scan.Translation() - site_from_world * (*truth)[i].Translation()).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(truth->size())),
            0.06);  // no loops here: control alone holds the shape
  for (const SolvedMark& mark : solution.marks) {
    EXPECT_TRUE(mark.used);
    EXPECT_LT(mark.residual.norm(), 0.01);
    EXPECT_GT(mark.covariance(0, 0), 0.0);
    EXPECT_LT(mark.covariance(0, 0), 1e-2);
  }
  ASSERT_FALSE(solution.covariances.empty());
}

TEST_F(RingWalk, CheckPointsAreSolvedButDoNotPull) {
  Session marked = *session;
  ControlNetwork control = MarkCorners(&marked, *truth, {}, {0, 210, 375, 600});
  const Track tied_track = TrackBlock(marked, {});
  const BlockAdjustment all = AdjustBlock(tied_track, {}, control, Stamps(), {});
  control.points.pop_back();  // C4 is not in the extract: a check point
  const BlockAdjustment three = AdjustBlock(tied_track, {}, control, Stamps(), {});
  ASSERT_TRUE(all.usable && three.usable);
  EXPECT_FALSE(three.solution.marks.back().used);
  EXPECT_EQ(three.solution.statistics.num_control_marks, 3);
  EXPECT_GT((three.solution.marks.back().position_in_site - all.solution.marks.back().position_in_site).norm(), 1e-6);
}

TEST_F(RingWalk, ExchangedLabelsAndAWrongTimeAreFoundAndExplained) {
  Session marked = *session;
  ControlNetwork control =
      MarkCorners(&marked, *truth, {500123.0, 5600456.0, 2.1}, {0, 105, 210, 300, 375, 480, 600, 750, 900});
  const Track tied_track = TrackBlock(marked, {});
  ControlNetwork exchanged = control;
  std::swap(exchanged.points[2].position_in_site, exchanged.points[5].position_in_site);
  const BlockAdjustment swapped = AdjustBlock(tied_track, {}, exchanged, Stamps(), {});
  ASSERT_TRUE(swapped.usable) << swapped.message;
  EXPECT_FALSE(swapped.solution.marks[2].used);
  EXPECT_FALSE(swapped.solution.marks[5].used);
  EXPECT_NE(swapped.solution.marks[2].left_out.find("C3 and C6 look exchanged"), std::string::npos)
      << swapped.solution.marks[2].left_out;

  for (Mark& mark : marked.marks) {
    if (mark.point != "C6") continue;  // written down half a second late, at 1 m/s
    mark.start_ns += 500'000'000;
    mark.end_ns += 500'000'000;
  }
  const BlockAdjustment late = AdjustBlock(TrackBlock(marked, {}), {}, control, Stamps(), {});
  ASSERT_TRUE(late.usable) << late.message;
  EXPECT_FALSE(late.solution.marks[5].used);
  EXPECT_NE(late.solution.marks[5].left_out.find("s earlier"), std::string::npos) << late.solution.marks[5].left_out;
}

TEST_F(RingWalk, OneControlPointIsRefusedUnlessAllowed) {
  Session marked = *session;
  const ControlNetwork control = MarkCorners(&marked, *truth, {1000, 2000, 0}, {210});
  const Track tied_track = TrackBlock(marked, {});
  const BlockAdjustment refused = AdjustBlock(tied_track, {}, control, Stamps(), {});
  EXPECT_FALSE(refused.usable);
  EXPECT_NE(refused.message.find("one control point"), std::string::npos);
  const BlockAdjustment allowed = AdjustBlock(tied_track, {}, control, Stamps(), {.allow_single_point = true});
  ASSERT_TRUE(allowed.usable);
  EXPECT_LT((allowed.solution.marks.front().position_in_site - control.points.front().position_in_site).norm(), 1e-6);
}

TEST_F(RingWalk, RenderedMapHasWallsWhereTheWallsAre) {
  const Pose2 site_from_world{500123.0, 5600456.0, 0.0};
  std::vector<Pose2> poses;
  for (const Pose2& pose : *truth) poses.push_back(site_from_world * pose);
  const SiteRaster raster = WholeOf(RenderBlock(*session, poses, {}));
  const auto value = [&](double x, double y) {
    const auto cell = raster.CellOf(site_from_world * Eigen::Vector2d(x, y));
    return raster.Contains(cell.x(), cell.y()) ? raster.At(static_cast<int>(cell.x()), static_cast<int>(cell.y()))
                                               : kUnknownLogOdds;
  };
  EXPECT_GT(value(12.01, 3.0), 0.5F);        // outer wall
  EXPECT_LT(value(10.5, 3.0), -0.5F);        // corridor
  EXPECT_TRUE(std::isnan(value(0.0, 0.0)));  // inside the core
}

}  // namespace
}  // namespace survey
