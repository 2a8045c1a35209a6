// SPDX-License-Identifier: Apache-2.0
//
// Two simulated blocks of one garage that share a control network, adjusted together.
#include "survey/graph/site_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "survey/stats/philox.h"
#include "tests/support/garage_block.h"

namespace {

using survey::Loop;
using survey::MatchedPair;
using survey::Pose2;
using survey::SiteAdjustment;
using survey::SiteBlock;
using test_support::GarageBlock;

constexpr double kRobustScale = 2.0;
constexpr double kMatchSigma_m = 0.02;
constexpr double kMatchSigma_rad = 0.003;
const Eigen::Matrix2d kIdentity2 = Eigen::Matrix2d::Identity();

struct GarageSite {
  survey::ControlNetwork control;
  std::vector<Pose2> truth;  // the same way in both blocks
  std::vector<SiteBlock> blocks;
};

SiteBlock AdjustedBlock(const std::string& name, GarageBlock* garage) {
  for (std::size_t i = 0; i < garage->site_from_pose.size(); ++i) garage->block.nodes.push_back({static_cast<int>(i)});
  const survey::ControlTie tie = test_support::AdjustGarageBlock(garage);
  return {.name = name, .graph = survey::MakeControlledGraph(garage->block, tie.offset), .covariances = {}};
}

GarageSite MakeSite(std::uint32_t seed) {
  GarageBlock first = test_support::SimulateGarageBlock(seed);
  GarageBlock second = test_support::SimulateGarageBlock(seed + 5000);
  second.control = first.control;
  GarageSite site{.control = first.control, .truth = first.site_from_pose, .blocks = {}};
  site.blocks = {AdjustedBlock("A", &first), AdjustedBlock("B", &second)};
  return site;
}

// Every tenth pose of the second block in the frame of that pose of the first, `shift` off.
std::vector<MatchedPair> Matches(const GarageSite& site, std::uint32_t seed, const Eigen::Vector2d& shift = {0, 0}) {
  const survey::RandomStream noise(seed, 77, 1);
  MatchedPair pair{.first = 0, .second = 1, .matches = {}};
  for (int i = 5; i < static_cast<int>(site.truth.size()); i += 10) {
    const auto index = static_cast<std::uint64_t>(i);
    const auto [x, y] = noise.Normals(2 * index);
    const Pose2 error{kMatchSigma_m * x + shift.x(), kMatchSigma_m * y + shift.y(),
                      kMatchSigma_rad * noise.Normal(2 * index + 1)};
    const Eigen::Vector3d sigmas(kMatchSigma_m, kMatchSigma_m, kMatchSigma_rad);
    pair.matches.push_back({.constraint = {{i}, {i}, error, sigmas.cwiseAbs2().asDiagonal()}});
  }
  return {pair};
}

double SquaredError(const SiteBlock& block, const std::vector<Pose2>& truth) {
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    squares += (block.graph.block.graph.poses[i].Translation() - truth[i].Translation()).squaredNorm();
  return squares / static_cast<double>(truth.size());
}

double SquaredDifference(const GarageSite& site) {
  double squares = 0.0;
  for (std::size_t i = 0; i < site.truth.size(); ++i)
    squares += (site.blocks[0].graph.block.graph.poses[i].Translation() -
                site.blocks[1].graph.block.graph.poses[i].Translation())
                   .squaredNorm();
  return squares / static_cast<double>(site.truth.size());
}

TEST(SiteAdjustmentTest, BlocksComeNearerToEachOtherAndToTheTruth) {
  double error_before = 0.0, error_after = 0.0, difference_before = 0.0, difference_after = 0.0;
  double normalised = 0.0;
  int count = 0;
  for (const std::uint32_t seed : {1, 2, 3, 4, 5, 6}) {
    GarageSite site = MakeSite(seed);
    difference_before += SquaredDifference(site);
    for (const SiteBlock& block : site.blocks) error_before += SquaredError(block, site.truth);
    const SiteAdjustment adjustment = AdjustSite(site.control, kRobustScale, &site.blocks, Matches(site, seed));
    ASSERT_TRUE(adjustment.usable) << adjustment.message;
    EXPECT_GE(adjustment.summary.pairs[0].num_used, adjustment.summary.pairs[0].num_matches - 1);
    EXPECT_EQ(adjustment.summary.num_shared, static_cast<int>(site.control.points.size()));
    difference_after += SquaredDifference(site);
    for (const SiteBlock& block : site.blocks) {
      error_after += SquaredError(block, site.truth);
      for (std::size_t i = 10; i < site.truth.size(); i += 40, ++count) {
        const Eigen::Vector2d error = block.graph.block.graph.poses[i].Translation() - site.truth[i].Translation();
        normalised += error.dot(block.covariances[i].topLeftCorner<2, 2>().inverse() * error);
      }
    }
  }
  EXPECT_LT(error_after, 0.95 * error_before);
  EXPECT_LT(difference_after, 0.6 * difference_before);
  EXPECT_NEAR(normalised / count, 2.0, 0.7);  // chi-square with two degrees of freedom; neighbours err alike
}

// However many blocks hang on it, the network is not better than it is: all its points share an error of 2 mm.
TEST(SiteAdjustmentTest, ControlCountsOnce) {
  GarageSite site = MakeSite(7);
  for (int copy = 0; copy < 8; ++copy) {
    site.blocks.push_back(site.blocks[static_cast<std::size_t>(copy % 2)]);
    site.blocks.back().name += std::to_string(copy);
  }
  ASSERT_TRUE(AdjustSite(site.control, kRobustScale, &site.blocks, {}).usable);
  for (const SiteBlock& block : site.blocks) {
    for (const Eigen::Matrix3d& covariance : block.covariances) EXPECT_GT(covariance(0, 0), 0.002 * 0.002);
  }
}

TEST(SiteAdjustmentTest, ContradictingMatchesAreNamedAndNotUsed) {
  GarageSite site = MakeSite(8);
  GarageSite without = site;
  const SiteAdjustment adjustment = AdjustSite(site.control, kRobustScale, &site.blocks, Matches(site, 8, {0.3, 0.0}));
  ASSERT_TRUE(AdjustSite(without.control, kRobustScale, &without.blocks, {}).usable);
  ASSERT_TRUE(adjustment.usable);
  EXPECT_TRUE(adjustment.summary.pairs[0].contradicts);
  EXPECT_EQ(adjustment.summary.pairs[0].num_used, 0);
  EXPECT_EQ(SquaredDifference(site), SquaredDifference(without));
}

// One bad match among good ones loses its weight.
TEST(SiteAdjustmentTest, OneWrongMatchDoesNotMatter) {
  GarageSite site = MakeSite(9);
  GarageSite clean = site;
  std::vector<MatchedPair> pairs = Matches(site, 9);
  ASSERT_TRUE(AdjustSite(clean.control, kRobustScale, &clean.blocks, pairs).usable);
  pairs[0].matches[7].constraint.submap_from_scan.x += 0.5;
  const SiteAdjustment adjustment = AdjustSite(site.control, kRobustScale, &site.blocks, pairs);
  EXPECT_LT(adjustment.summary.pairs[0].num_used, adjustment.summary.pairs[0].num_matches);
  EXPECT_GE(adjustment.summary.pairs[0].num_used, adjustment.summary.pairs[0].num_matches - 3);
  EXPECT_NEAR(std::sqrt(SquaredError(site.blocks[1], site.truth)),
              std::sqrt(SquaredError(clean.blocks[1], clean.truth)), 1e-3);
}

TEST(SiteAdjustmentTest, ABlockWithoutControlStaysAsItWas) {
  GarageSite site = MakeSite(10);
  site.blocks[1].graph.control.resize(1);
  const double before = SquaredError(site.blocks[1], site.truth);
  const SiteAdjustment adjustment = AdjustSite(site.control, kRobustScale, &site.blocks, Matches(site, 10));
  EXPECT_TRUE(adjustment.usable) << adjustment.message;
  EXPECT_EQ(adjustment.summary.apart, std::vector<std::string>{"B"});
  EXPECT_TRUE(site.blocks[1].covariances.empty());
  EXPECT_EQ(SquaredError(site.blocks[1], site.truth), before);
}

// What a person said of a scan's place in the site holds in the joint solution too.
TEST(SiteAdjustmentTest, AnswersInTheSiteFrameStay) {
  GarageSite site = MakeSite(11);
  survey::ControlledGraph& first = site.blocks[0].graph;
  first.site_pose = static_cast<int>(first.block.graph.poses.size());
  const int target = 120;
  first.block.graph.edges.push_back({*first.site_pose, target, site.truth[target],
                                     Eigen::Vector3d(1e-8, 1e-8, 1e-10).asDiagonal(), false,
                                     survey::EdgeKind::kAnswer});
  first.block.graph.poses.emplace_back();
  const SiteAdjustment adjustment = AdjustSite(site.control, kRobustScale, &site.blocks, Matches(site, 11));
  ASSERT_TRUE(adjustment.usable) << adjustment.message;
  EXPECT_LT((first.block.graph.poses[target].Translation() - site.truth[target].Translation()).norm(), 3e-4);
  EXPECT_EQ(first.block.graph.poses.back().x, 0.0);
  EXPECT_EQ(site.blocks[0].covariances.size() + 1, first.block.graph.poses.size());
}

// The solution follows its graph: scans between two nodes, marks and their residuals.
TEST(SiteAdjustmentTest, SolutionFollowsTheGraph) {
  survey::Track track;
  for (int i = 0; i < 3; ++i) track.scans.push_back({.scan = {i}, .local_from_scan = {1.0 * i, 0, 0}});
  track.scans[0].is_node = track.scans[2].is_node = true;
  SiteBlock block{.name = "A", .graph = {}, .covariances = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()}};
  block.graph.block.nodes = {{0}, {2}};
  block.graph.block.graph.poses = {{0, 0.01, 0}, {2, 0.03, 0}};
  block.graph.block.graph.points = {{2, 1}};
  block.graph.block.graph.marks = {{.pose = 1, .point = 0, .p_in_pose = {0, 1}}};
  survey::Solution solution;
  for (const survey::TrackedScan& scan : track.scans) solution.scans.push_back({scan.scan, scan.local_from_scan});
  solution.covariances = {{{2}, Eigen::Matrix3d::Zero()}};
  solution.marks.resize(1);
  solution.marks[0].used = true;
  solution.marks[0].position_in_site = {2, 1};
  solution.marks[0].residual = {0, -0.02};
  const survey::JointBlock report = MoveSolution(block, track, {0, 1, 2}, &solution);
  EXPECT_NEAR(solution.scans[1].site_from_scan.y, 0.02, 1e-12);
  EXPECT_NEAR(solution.marks[0].position_in_site.y(), 1.03, 1e-12);
  EXPECT_NEAR(solution.marks[0].residual.y(), 0.01, 1e-12);
  EXPECT_EQ(solution.covariances[0].covariance, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  EXPECT_NEAR(report.max_shift, 0.03, 1e-12);
  EXPECT_NEAR(report.rms_shift, std::sqrt((1.0 + 4.0 + 9.0) / 3.0) / 100.0, 1e-12);
}

// A person says that a place of block A lies 3 cm beside where it was adjusted, and is sure of it to 5 mm.
TEST(AdjustSite, WhatWasGivenForABlocksOwnPointCounts) {
  GarageSite site = MakeSite(31);
  GarageSite without = site;
  survey::BlockGraph& block = site.blocks[0].graph.block;
  constexpr int kPose = 90;
  const Eigen::Vector2d place = block.graph.poses[kPose].Translation();
  const Eigen::Vector2d head = place + Eigen::Vector2d(0.03, 0.0);
  block.graph.marks.push_back({kPose, static_cast<int>(block.graph.points.size()), {0, 0}, 1e-6 * kIdentity2});
  block.graph.given.push_back({{static_cast<int>(block.graph.points.size())}, head, 2.5e-5 * kIdentity2});
  block.graph.points.push_back(place);
  ASSERT_TRUE(survey::AdjustSite(site.control, kRobustScale, &site.blocks, {}).usable);
  ASSERT_TRUE(survey::AdjustSite(without.control, kRobustScale, &without.blocks, {}).usable);
  const Eigen::Vector2d moved = site.blocks[0].graph.block.graph.poses[kPose].Translation() -
                                without.blocks[0].graph.block.graph.poses[kPose].Translation();
  EXPECT_GT(moved.x(), 0.002);
  EXPECT_LT(moved.x(), 0.03);
  EXPECT_LT(std::abs(moved.y()), moved.x());
}

}  // namespace
