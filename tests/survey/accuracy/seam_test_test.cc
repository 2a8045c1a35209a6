// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/seam_test.h"

#include <gtest/gtest.h>

#include "survey/graph/map_uncertainty.h"
#include "survey/stats/philox.h"

namespace {

using Eigen::Vector2d;

// One pose at the origin, known to sigma_m in both axes and to sigma_rad.
survey::Solution BlockKnownTo(double sigma_m, double sigma_rad) {
  survey::Solution solution;
  solution.scans = {{.scan = survey::ScanId{0}}};
  const Eigen::Vector3d sigmas(sigma_m, sigma_m, sigma_rad);
  solution.covariances = {{survey::ScanId{0}, sigmas.cwiseAbs2().asDiagonal()}};
  return solution;
}

survey::Seam SeamOf(const std::vector<Vector2d>& offsets) {
  survey::Seam seam;
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& offset : offsets) {
    seam.patches.push_back({.offset = offset, .directions = 2});
    sum += offset;
  }
  seam.offset = sum / static_cast<double>(offsets.size());
  return seam;
}

TEST(SeamTest, HeadingCountsByTheDistance) {
  const auto covariance = survey::MapCovarianceAt({0, 30}, BlockKnownTo(0.003, 0.001));
  ASSERT_TRUE(covariance.has_value());
  EXPECT_NEAR((*covariance)(0, 0), 0.003 * 0.003 + 0.03 * 0.03, 1e-12);
  EXPECT_NEAR((*covariance)(1, 1), 0.003 * 0.003, 1e-12);
  EXPECT_FALSE(survey::MapCovarianceAt({0, 0}, survey::Solution()).has_value());
}

TEST(SeamTest, OffsetsWithinTheCovarianceAreNoContradiction) {
  const survey::Solution block = BlockKnownTo(0.01, 0.0);
  const survey::Seam seam = SeamOf({{0.02, 0.01}, {0.015, 0.02}, {0.0, 0.01}});
  const auto verdict = survey::JudgeSeam(seam, block, block, 0.01);
  ASSERT_TRUE(verdict.has_value());
  EXPECT_FALSE(verdict->contradicts);
  EXPECT_NEAR(verdict->patch_ratios[0], std::sqrt((0.0004 + 0.0001) / 0.0003 / 2), 1e-12);
  const auto sure = survey::JudgeSeam(seam, BlockKnownTo(0.001, 0.0), BlockKnownTo(0.001, 0.0), 0.002);
  EXPECT_TRUE(sure->contradicts);
  EXPECT_FALSE(survey::JudgeSeam(seam, block, survey::Solution(), 0.01).has_value());
}

TEST(SeamTest, FewWindowsBeyondAreClutterManyAreNot) {
  const survey::Solution block = BlockKnownTo(0.005, 0.0);
  std::vector<Vector2d> offsets(20, Vector2d(0.002, -0.002));
  for (const std::size_t i : {3U, 8U}) offsets[i] = {0.08, 0.0};
  for (const std::size_t i : {5U, 9U}) offsets[i] = {-0.08, 0.0};
  const auto cluttered = survey::JudgeSeam(SeamOf(offsets), block, block, 0.005);
  EXPECT_EQ(cluttered->num_beyond, 4);
  EXPECT_FALSE(cluttered->contradicts);
  offsets[12] = {0.0, 0.08};
  EXPECT_TRUE(survey::JudgeSeam(SeamOf(offsets), block, block, 0.005)->contradicts);
}

// Windows that all scatter by centimetres without a common shift: the seam is noisy, the blocks do not contradict.
TEST(SeamTest, ScatterIsTakenFromTheSeam) {
  const survey::Solution block = BlockKnownTo(0.003, 0.0);
  const survey::RandomStream random(9, 0, 0);
  std::vector<Vector2d> offsets;
  for (std::uint64_t i = 0; i < 60; ++i)
    offsets.emplace_back(0.03 * random.Normal(2 * i), 0.03 * random.Normal(2 * i + 1));
  EXPECT_FALSE(survey::JudgeSeam(SeamOf(offsets), block, block, 0.01)->contradicts);
  for (Vector2d& offset : offsets) offset.x() += 0.06;
  EXPECT_TRUE(survey::JudgeSeam(SeamOf(offsets), block, block, 0.01)->contradicts);
}

TEST(SeamTest, FalseAlarmsAreAsRareAsClaimed) {
  const survey::Solution block = BlockKnownTo(0.01, 0.0);
  const survey::RandomStream random(5, 0, 0);
  int beyond = 0;
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    const auto index = static_cast<std::uint64_t>(2 * i);
    const double sigma = std::sqrt(2.0) * 0.01;
    const survey::Seam seam = SeamOf({sigma * Vector2d(random.Normal(index), random.Normal(index + 1))});
    beyond += survey::JudgeSeam(seam, block, block, 0.0)->num_beyond;
  }
  EXPECT_GE(beyond, 5);
  EXPECT_LE(beyond, 40);  // 20 expected
}

}  // namespace
