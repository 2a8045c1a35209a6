// SPDX-License-Identifier: Apache-2.0
//
// Requests of the particle filter on a straight way, an update every half metre, four particles.
#include "survey/particles/filter_requests.h"

#include <gtest/gtest.h>

#include <cmath>

namespace survey {
namespace {

struct StraightWay : public testing::Test {
  StraightWay() {
    for (int i = 0; i < 80; ++i) {
      const Pose2 pose{0.5 * i, 0.0, 0.0};
      local.scans.push_back({.scan = {i}, .local_from_scan = pose, .matched = true});
      tree.push_back({.scan = {i},
                      .poses = std::vector<Pose2>(4, pose),
                      .parents = {0, 1, 2, 3},
                      .log_weights = std::vector<double>(4, std::log(0.25)),
                      .effective_size = 4.0});
    }
    filtered = local;
  }
  std::vector<ReviewRequest> Requests(int updates_together = 5) const {
    Track track = filtered;
    AddFilterRequests(local, tree, updates_together, &track);
    return track.requests;
  }
  void DropAt(std::size_t k, double spread) {
    tree[k].resampled = true;
    tree[k].effective_size = 1.5;
    tree[k].spread = {spread, 0.0, 0.0};
  }

  Track local;
  Track filtered;
  TrajectoryTree tree;
};

TEST_F(StraightWay, NothingIsAskedWhereAllAgree) { EXPECT_TRUE(Requests().empty()); }

TEST_F(StraightWay, DropsThatFollowEachOtherAreOneRequestAtTheWorstOrEachIsAsked) {
  DropAt(10, 0.1);
  DropAt(13, 0.3);
  DropAt(17, 0.2);
  DropAt(40, 0.1);
  const std::vector<ReviewRequest> requests = Requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[0].scan.value, 13);
  EXPECT_EQ(requests[0].doubt, 0.3);
  EXPECT_EQ(requests[0].message,
            "effective sample size 1.5 of 4, particles spread over 0.300 m, 0.00 degrees (1 sigma); 3 drops in a row");
  EXPECT_EQ(requests[1].scan.value, 40);
  EXPECT_EQ(Requests(0).size(), 4U);
}

TEST_F(StraightWay, GroupsOfParticlesAreModes) {
  tree[20].poses[3].y = 1.0;
  tree[20].poses[2].y = 0.1;
  const std::vector<ReviewRequest> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].cause, "several_modes");
  EXPECT_NEAR(requests[0].doubt, 0.25, 1e-12);
  ASSERT_EQ(requests[0].modes.size(), 2U);
  EXPECT_NEAR(requests[0].modes[0].weight, 0.75, 1e-12);
  EXPECT_EQ(requests[0].modes[1].local_from_scan.y, 1.0);
}

TEST_F(StraightWay, TheEnginesDisagreeWhereTheyMovedOtherwise) {
  for (std::size_t i = 50; i < 80; ++i) filtered.scans[i].local_from_scan.y = 0.5;
  const std::vector<ReviewRequest> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].cause, "engines_disagree");
  EXPECT_EQ(requests[0].scan.value, 50);
  EXPECT_NEAR(requests[0].doubt, 0.5, 1e-12);
  EXPECT_NEAR(requests[0].modes.at(0).local_from_scan.y, 0.0, 1e-12);
}

TEST_F(StraightWay, AFilterThatLostItsWayIsABreak) {
  tree[33].lost = true;
  ASSERT_EQ(Requests().size(), 1U);
  EXPECT_EQ(Requests()[0].cause, "break");
}

}  // namespace
}  // namespace survey
