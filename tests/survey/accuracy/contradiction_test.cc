// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/contradiction.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "tests/support/room.h"

namespace survey {
namespace {

// Two laps in the furnished room.
std::vector<Pose2> Laps() {
  std::vector<Pose2> poses;
  for (int i = 0; i < 320; ++i) {
    const double angle = 4.0 * std::numbers::pi * i / 320;
    poses.push_back({2.5 * std::cos(angle), 1.5 * std::sin(angle), NormalizeAngle(angle + 1.57)});
  }
  return poses;
}

struct TwoLaps : public testing::Test {
  std::vector<Pose2> truth = Laps();
  Session session = test_support::SimulateSession(test_support::FurnishedRoom(), truth, 10.0, 0.01, 1.0, 0.0);
  ContradictionOptions options{.piece_m = 3.0, .apart_m = 8.0};

  // The second lap displaced.
  std::vector<Pose2> Displaced(const Pose2& by) const {
    std::vector<Pose2> poses = truth;
    for (std::size_t i = poses.size() / 2; i < poses.size(); ++i) poses[i] = by * poses[i];
    return poses;
  }
};

TEST_F(TwoLaps, TrueMapsDoNotContradictThemselves) {
  const Contradiction passes = ComparePasses(session, truth, options).total;
  EXPECT_GT(passes.compared, 1000);
  EXPECT_LT(passes.Share(), 0.01);
}

TEST_F(TwoLaps, ADoubledWallDoesAndTheMoreTheFartherItIsOff) {
  const double near = ComparePasses(session, Displaced({0.2, 0.0, 0.0}), options).total.Share();
  const double far = ComparePasses(session, Displaced({1.2, 0.8, 0.1}), options).total.Share();
  EXPECT_LT(near, 0.02);
  EXPECT_GT(far, 0.15);
}

TEST_F(TwoLaps, AConflictNamesTheDisplacedPassAndTheOneThatItContradicts) {
  EXPECT_TRUE(ComparePasses(session, truth, options).conflicts.empty());
  const std::vector<PassConflict> conflicts = ComparePasses(session, Displaced({1.2, 0.8, 0.1}), options).conflicts;
  ASSERT_FALSE(conflicts.empty());
  for (const PassConflict& conflict : conflicts) {
    EXPECT_GT(conflict.last.value, 150);  // the second lap begins with scan 160
    EXPECT_LT(conflict.other_last.value, 160);
    EXPECT_GE(conflict.walls.Share(), 0.15);
  }
}

TEST_F(TwoLaps, SiteCoordinatesAndThreadsChangeNothing) {
  const std::vector<Pose2> poses = Displaced({1.2, 0.8, 0.1});
  const Contradiction local = ComparePasses(session, poses, options).total;
  std::vector<Pose2> in_site;
  for (const Pose2& pose : poses) in_site.push_back({pose.x + 500000.0, pose.y + 5600000.0, pose.theta});
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  const Contradiction site = ComparePasses(session, in_site, options).total;
  EXPECT_NEAR(site.Share(), local.Share(), 0.002);
  EXPECT_NEAR(site.compared, local.compared, 0.002 * local.compared);
}

TEST_F(TwoLaps, OneLapHasNothingToCompare) {
  options.apart_m = 100.0;
  EXPECT_EQ(ComparePasses(session, truth, options).total.compared, 0);
}

}  // namespace
}  // namespace survey
