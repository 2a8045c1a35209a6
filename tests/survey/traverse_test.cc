// SPDX-License-Identifier: Apache-2.0
//
// The way to a corrected pose: straight on by steps of half a metre, an update every metre, blind from 10 m to 14 m,
// where the odometry missed a turn. Behind it everything is displaced as one piece until a person corrects it.
#include "survey/particles/traverse.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "survey/particles/trajectory_tree.h"

namespace survey {
namespace {

constexpr int kScans = 61;
constexpr int kBlindFrom = 20;
constexpr int kBlindUntil = 28;

Pose2 Tracked(int scan) { return {0.5 * scan, 0.0, 0.0}; }

// The missed turn comes evenly over the blind stretch.
Pose2 Truth(int scan) {
  Pose2 pose = Tracked(std::min(scan, kBlindFrom));
  for (int i = kBlindFrom + 1; i <= scan; ++i) {
    const double half = i <= kBlindUntil ? 0.5 * 0.2 / (kBlindUntil - kBlindFrom) : 0.0;
    pose = pose * Pose2{0.0, 0.0, half} * Pose2{0.5, 0.0, half};
  }
  return pose;
}

struct BlindStretch : public testing::Test {
  BlindStretch() {
    for (int i = 0; i < kScans; ++i) {
      const bool blind = i > kBlindFrom && i < kBlindUntil;
      track.scans.push_back({.scan = {i}, .local_from_scan = Tracked(i), .matched = !blind});
      if (i % 2 != 0 || blind) continue;
      tree.push_back({.scan = {i}});
      trajectory.push_back(Tracked(i));
    }
  }
  std::size_t UpdateOf(int scan) const {
    const auto same = [scan](const FilterUpdate& update) { return update.scan.value == scan; };
    return static_cast<std::size_t>(std::find_if(tree.begin(), tree.end(), same) - tree.begin());
  }
  static Answer Given(int scan, Decision decision) {
    return {.name = "a.json",
            .scan = {scan},
            .decision = decision,
            .reference = {0},
            .reference_from_scan = Between(Truth(0), Truth(scan))};
  }
  // The filter puts the particles where the person says.
  void Correct(int scan) {
    answers.push_back(Given(scan, Decision::kCorrect));
    for (std::size_t k = UpdateOf(scan); k < tree.size(); ++k) trajectory[k] = Truth(tree[k].scan.value);
  }
  double ErrorAfterwards(int scan) const {
    std::vector<Pose2> closed = trajectory;
    CloseTraverses(track, tree, answers, {}, &closed);
    return (closed[UpdateOf(scan)].Translation() - Truth(scan).Translation()).norm();
  }

  Track track;
  TrajectoryTree tree;
  Answers answers;
  std::vector<Pose2> trajectory;
};

TEST_F(BlindStretch, TakesTheErrorThatACorrectionShows) {
  EXPECT_GT(ErrorAfterwards(50), 2.0);
  Correct(50);
  EXPECT_LT(ErrorAfterwards(10), 0.1);
  EXPECT_LT(ErrorAfterwards(20), 0.15);
  EXPECT_LT(ErrorAfterwards(28), 0.15);
  EXPECT_LT(ErrorAfterwards(40), 0.15);
  EXPECT_LT(ErrorAfterwards(50), 1e-12);
}

TEST_F(BlindStretch, WhatWasConfirmedBeforeStays) {
  answers.push_back(Given(20, Decision::kConfirm));
  Correct(50);
  EXPECT_LT(ErrorAfterwards(10), 1e-12);
  EXPECT_LT(ErrorAfterwards(20), 1e-12);
  EXPECT_LT(ErrorAfterwards(40), 0.15);
}

TEST_F(BlindStretch, NothingMovesWithoutACorrection) {
  answers.push_back(Given(20, Decision::kConfirm));
  const double before = (trajectory[UpdateOf(40)].Translation() - Truth(40).Translation()).norm();
  EXPECT_NEAR(ErrorAfterwards(40), before, 1e-12);
}

}  // namespace
}  // namespace survey
