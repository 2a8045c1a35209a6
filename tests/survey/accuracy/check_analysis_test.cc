// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/check_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "survey/accuracy/circular_error.h"
#include "survey/accuracy/outliers.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

Eigen::Vector2d Noise(const RandomStream& random, std::uint64_t i, double sigma = 0.01) {
  const auto [a, b] = random.Normals(i);
  return {sigma * a, sigma * b};
}

// Weights of eleven men, the published example of [Royston95]: W = 0.79, p = 0.0067.
TEST(NormalityTest, PublishedExample) {
  const std::optional<ShapiroWilk> test = TestShapiroWilk({148, 154, 158, 160, 161, 162, 166, 170, 182, 195, 236});
  ASSERT_TRUE(test);
  EXPECT_NEAR(test->w, 0.7888, 5e-5);
  EXPECT_NEAR(test->p_value, 0.006704, 5e-6);
}

// Three values: W is the share of the outer difference, by hand 27/28 for 0, 1, 3, and the p-value a closed form.
TEST(NormalityTest, ThreeValuesByHand) {
  const std::optional<ShapiroWilk> test = TestShapiroWilk({3, 0, 1});
  EXPECT_NEAR(test->w, 27.0 / 28.0, 1e-12);
  EXPECT_NEAR(test->p_value, 6.0 / M_PI * (std::asin(std::sqrt(27.0 / 28.0)) - M_PI / 3.0), 1e-12);
  EXPECT_FALSE(TestShapiroWilk({2, 2, 2}));
  EXPECT_FALSE(TestShapiroWilk({1, 2}));
}

TEST(NormalityTest, HoldsItsLevelAndFindsHeavyTails) {
  constexpr int kSets = 400;
  int alarms = 0, found = 0;
  for (std::uint32_t set = 0; set < kSets; ++set) {
    const RandomStream random(11, 0, set);
    std::vector<Eigen::Vector2d> normal, heavy;
    for (std::uint64_t i = 0; i < 40; ++i) {
      normal.push_back(Noise(random, i));
      heavy.push_back(Noise(random, i, i % 10 == 0 ? 0.05 : 0.01));
    }
    alarms += TestNormality(normal)->Rejected() ? 1 : 0;
    found += TestNormality(heavy)->Rejected() ? 1 : 0;
  }
  EXPECT_LE(alarms, 0.07 * kSets);
  EXPECT_GE(alarms, 0.01 * kSets);
  EXPECT_GE(found, 0.8 * kSets);
}

TEST(OutliersTest, HoldsItsLevelAndFindsTwo) {
  constexpr int kSets = 400;
  int alarms = 0;
  for (std::uint32_t set = 0; set < kSets; ++set) {
    const RandomStream random(12, 0, set);
    std::vector<Eigen::Vector2d> errors;
    for (std::uint64_t i = 0; i < 30; ++i) errors.push_back(Noise(random, i));
    alarms += FindErrorOutliers(errors).empty() ? 0 : 1;
    errors[7] = {0.08, 0.0};
    errors[20] = {0.075, 0.01};  // hides behind the first until that is gone
    const std::vector<int> found = FindErrorOutliers(errors);
    EXPECT_EQ(std::count(found.begin(), found.end(), 7), 1) << set;
    EXPECT_EQ(std::count(found.begin(), found.end(), 20), 1) << set;
  }
  EXPECT_NEAR(alarms, 0.05 * kSets, 0.03 * kSets);
}

// Two blocks by hand: within (1/2)(2 0; 0 2) each, means 0 and (1, 0) -> lambda = 4 * 4 / ((4 + 2) * 4).
TEST(ClusteringTest, BlockEffectByHand) {
  std::vector<Eigen::Vector2d> errors;
  std::vector<int> blocks;
  for (const int block : {0, 1}) {
    for (const Eigen::Vector2d& d : {Eigen::Vector2d(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      errors.emplace_back(d + Eigen::Vector2d(block, 0));
      blocks.push_back(block);
    }
  }
  const std::optional<BlockEffect> effect = TestBlockEffect(errors, blocks);
  ASSERT_TRUE(effect);
  EXPECT_NEAR(effect->wilks_lambda, 16.0 / 24.0, 1e-12);
  EXPECT_NEAR(effect->f, (1 - std::sqrt(2.0 / 3)) / std::sqrt(2.0 / 3) * 5.0, 1e-12);
  EXPECT_FALSE(TestBlockEffect(errors, std::vector<int>(8, 3)));
}

TEST(ClusteringTest, LevelsAndPower) {
  constexpr int kSets = 300;
  int block_alarms = 0, moran_alarms = 0, blocks_found = 0, moran_found = 0;
  for (std::uint32_t set = 0; set < kSets; ++set) {
    const RandomStream random(13, 0, set);
    std::vector<PlacedError> free, clustered;
    for (int i = 0; i < 24; ++i) {
      const auto index = static_cast<std::uint64_t>(i);
      const Eigen::Vector2d place(5.0 * i, 3.0 * (i % 2));
      free.push_back({.point = i, .block = i / 8, .position = place, .error = Noise(random, index)});
      clustered.push_back(free.back());
      clustered.back().error += Eigen::Vector2d(0.015 * (i / 8 - 1), 0);
    }
    std::vector<int> outliers;
    const CheckAnalysis a = AnalyseErrors(free, &outliers), b = AnalyseErrors(clustered, &outliers);
    block_alarms += a.block_effect->p_value < 0.05 ? 1 : 0;
    moran_alarms += a.moran->p_value < 0.05 ? 1 : 0;
    blocks_found += b.block_effect->p_value < 0.05 ? 1 : 0;
    moran_found += b.moran->p_value < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(block_alarms, 0.05 * kSets, 0.035 * kSets);
  EXPECT_NEAR(moran_alarms, 0.05 * kSets, 0.035 * kSets);
  EXPECT_GE(blocks_found, 0.9 * kSets);
  EXPECT_GE(moran_found, 0.7 * kSets);
}

TEST(QuantileTest, OrderStatisticsBoundIt) {
  std::vector<double> lengths;
  for (int i = 1; i <= 59; ++i) lengths.push_back(i);
  EXPECT_NEAR(EstimateQuantile(lengths, 0.95).value, 1 + 0.95 * 58, 1e-9);
  EXPECT_EQ(EstimateQuantile(lengths, 0.95).upper_95, 59.0);  // 0.95^59 = 0.0485
  lengths.pop_back();
  EXPECT_FALSE(EstimateQuantile(lengths, 0.95).upper_95);
  EXPECT_EQ(EstimateQuantile({0.03}, 0.683).value, 0.03);
}

TEST(SpreadTest, HullQuadrantsAndDistances) {
  EXPECT_DOUBLE_EQ(ConvexHullArea({{0, 0}, {4, 0}, {4, 3}, {0, 3}, {2, 1}, {2, 0}}), 12.0);
  EXPECT_DOUBLE_EQ(ConvexHullArea({{0, 0}, {1, 1}, {2, 2}}), 0.0);
  const std::vector<Eigen::Vector2d> scans = {{0, 0}, {20, 0}, {20, 10}, {0, 10}};
  const std::vector<Eigen::Vector2d> checks = {{15, 8}, {16, 9}, {15, 9}, {2, 1}}, control = {{15, 6}};
  const std::optional<CheckSpread> spread = DescribeSpread(checks, scans, control);
  EXPECT_EQ(spread->quadrant_shares, (std::vector<double>{0.75, 0, 0.25, 0}));
  EXPECT_TRUE(spread->Uneven());
  EXPECT_DOUBLE_EQ(spread->nearest_control_min, 2.0);
  EXPECT_DOUBLE_EQ(spread->nearest_control_max, std::hypot(13, 5));
  EXPECT_FALSE(DescribeSpread({}, scans, control));
  const std::optional<FarFromControl> far = FindFarFromControl(scans, control, 12.0);
  EXPECT_EQ(far->farthest, Eigen::Vector2d(0, 0));
  EXPECT_DOUBLE_EQ(far->path_length, 20.0);
  EXPECT_FALSE(FindFarFromControl(scans, control, 50.0));
}

std::vector<PositionError> Draw(std::uint32_t set, int n, double sigma_e, double sigma_n) {
  const RandomStream random(14, 0, set);
  std::vector<PositionError> errors;
  for (int i = 0; i < n; ++i) {
    const auto [a, b] = random.Normals(static_cast<std::uint64_t>(i));
    errors.push_back({.point = i, .error = {sigma_e * a, sigma_n * b}});
  }
  return errors;
}

struct Truth {
  int n;
  double ratio;  // of the sigmas of the axes
};

class DemonstratedTest : public testing::TestWithParam<Truth> {};

// A class whose limit is the truth itself must not be "demonstrated" more often than in one test of twenty.
TEST_P(DemonstratedTest, IsWrongInFivePercentAtMost) {
  constexpr int kSets = 1000;
  const auto [n, ratio] = GetParam();
  const Eigen::Matrix2d covariance = Eigen::Vector2d(1.0, ratio * ratio).asDiagonal();
  const std::vector<AccuracyClass> classes = {
      {.statistic = ClassStatistic::kRmseHorizontal, .limit_m = std::hypot(1.0, ratio)},
      {.statistic = ClassStatistic::kRmseAxis, .limit_m = 1.0},
      {.statistic = ClassStatistic::kCircle95, .limit_m = CircularError(0.95, Eigen::Vector2d::Zero(), covariance)},
      {.statistic = ClassStatistic::kNssda95, .limit_m = 1.7308 * std::hypot(1.0, ratio)}};
  std::vector<int> wrong(classes.size(), 0);
  for (std::uint32_t set = 0; set < kSets; ++set) {
    const std::vector<ClassResult> results = JudgeClasses(Summarize(Draw(set, n, 1.0, ratio)), classes);
    for (std::size_t c = 0; c < classes.size(); ++c) wrong[c] += results[c].demonstrated ? 1 : 0;
  }
  const double three_sigma = 3.0 * std::sqrt(0.05 * 0.95 / kSets);
  for (std::size_t c = 0; c < classes.size(); ++c) EXPECT_LE(wrong[c], (0.05 + three_sigma) * kSets) << c;
}

INSTANTIATE_TEST_SUITE_P(Samples, DemonstratedTest,
                         testing::Values(Truth{5, 1.0}, Truth{5, 0.2}, Truth{12, 0.5}, Truth{40, 1.0}));

TEST(ClassTest, NothingAndOneCheck) {
  const std::vector<AccuracyClass> classes = {{.statistic = ClassStatistic::kCircle95, .limit_m = 1.0}};
  EXPECT_TRUE(JudgeClasses(Summarize({}), classes).empty());
  const std::vector<PositionError> one = {{.point = 0, .error = {0.03, 0.04}}};
  const std::vector<ClassResult> results = JudgeClasses(Summarize(one), classes);
  EXPECT_TRUE(results[0].meets);
  EXPECT_FALSE(results[0].demonstrated);
  EXPECT_FALSE(results[0].upper_95);
}

}  // namespace
}  // namespace survey
