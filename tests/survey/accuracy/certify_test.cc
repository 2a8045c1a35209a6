// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

const Eigen::Matrix2d kSurvey = Eigen::Matrix2d::Identity() * 0.002 * 0.002;

SolvedMark Used(const std::string& point, const Eigen::Vector2d& given, const Eigen::Vector2d& residual) {
  return {.point = point,
          .used = true,
          .position_in_site = given + residual,
          .residual = residual,
          .rigid_residual = 10.0 * residual};
}

NamedFeature Surveyed(const std::string& name, const Eigen::Vector2d& position) {
  return {.name = name, .position_in_site = position, .covariance = kSurvey};
}

MapFeature Seen(const std::string& name, const Eigen::Vector2d& position) {
  return {.name = name, .found = true, .position_in_site = position, .covariance = kSurvey};
}

// Two tied blocks and one that is not; a check point in B1, features in B1 and B2.
CertifyInput Input() {
  CertifyInput input{.site = "garage", .network = {.frame = {.crs = "EPSG:25832"}}, .class_m = 0.05};
  input.network.points = {{.name = "C1", .position_in_site = {0, 0}, .covariance = kSurvey},
                          {.name = "C2", .position_in_site = {10, 0}, .covariance = kSurvey},
                          {.name = "K1", .role = PointRole::kCheck, .position_in_site = {5, 5}, .covariance = kSurvey},
                          {.name = "K2", .role = PointRole::kCheck, .position_in_site = {9, 9}, .covariance = kSurvey}};
  input.reference_features = {Surveyed("F1", {0, 1}), Surveyed("F2", {8, 1}), Surveyed("F3", {8, 7})};
  Solution tied{.tied = true, .frame = input.network.frame};
  tied.marks = {Used("C1", {0, 0}, {0.001, 0}),
                Used("C2", {10, 0}, {0, 0.003}),
                {.point = "K1", .position_in_site = {5.03, 4.96}}};
  tied.scans = {{.site_from_scan = {0, 0, 0}}, {.site_from_scan = {3, 4, 0}}};
  input.blocks.push_back({"B1", tied, {Seen("F1", {0.02, 1}), Seen("F2", {8.02, 1}), Seen("F3", {8.02, 7})}});
  tied.marks.pop_back();
  input.blocks.push_back({"B2", tied, {Seen("F1", {0, 1.04})}});
  Solution loose;
  loose.marks = {{.point = "K1", .position_in_site = {700, 700}}};
  input.blocks.push_back({"B3", loose, {Seen("F1", {500, 500})}});
  return input;
}

TEST(CertifyTest, KeepsTheLevelsApart) {
  const Certificate c = Certify(Input());
  EXPECT_TRUE(c.tied);
  // fit: four marks on two points, never among the checks.
  EXPECT_EQ(c.fit.size(), 4U);
  EXPECT_EQ(c.blocks[0].num_control_points, 2);
  EXPECT_NEAR(c.blocks[0].fit_rms, std::sqrt((1e-6 + 9e-6) / 2), 1e-12);
  EXPECT_NEAR(c.blocks[0].rigid_fit_rms, 10 * c.blocks[0].fit_rms, 1e-12);
  EXPECT_EQ(c.blocks[0].path_length, 5.0);
  // tested points: K1 in B1 alone, sqrt(0.03^2 + 0.04^2); its survey is 2 (2 mm)^2 plus centring 2 (5 mm)^2.
  EXPECT_EQ(c.points_test.statistics.num_points, 1);
  EXPECT_NEAR(c.points_test.statistics.rmse, 0.05, 1e-9);
  EXPECT_NEAR(c.points_test.statistics.rmse_survey, std::sqrt(2 * (4e-6 + 25e-6)), 1e-9);
  EXPECT_FALSE(c.points_test.verdict->meets);
  // tested features: three points, four errors.
  EXPECT_EQ(c.features_test.statistics.num_points, 3);
  EXPECT_EQ(c.features_test.statistics.num_errors, 4);
  EXPECT_NEAR(c.features_test.statistics.rmse, std::sqrt((3 * 0.0004 + 0.0016) / 4), 1e-9);
  // relative: B1 is shifted as a whole. stitching: F1 between B1 and B2.
  ASSERT_TRUE(c.blocks[0].relative);
  EXPECT_NEAR(c.blocks[0].relative->rms, 0.0, 1e-9);
  EXPECT_FALSE(c.blocks[1].relative);
  ASSERT_EQ(c.stitching.pairs.size(), 1U);
  EXPECT_NEAR(c.stitching.rms, std::hypot(0.02, 0.04), 1e-9);
}

TEST(CertifyTest, ABrokenTrackIsListedAndNotDemonstrated) {
  CertifyInput input = Input();
  input.class_m = 1.0;  // which all checks meet
  const Certificate sound = Certify(input);
  EXPECT_TRUE(sound.statement.meets.value());
  input.blocks[1].solution.breaks = {{ScanId{17}, "80 scans without a match in the map, 2.0 s"}};
  input.blocks[1].solution.navigation = {.inertial_s = 10, .constant_velocity_s = 3, .unmatched_s = 2};
  const Certificate broken = Certify(input);
  EXPECT_TRUE(broken.statement.meets.value());
  EXPECT_FALSE(broken.statement.demonstrated.value());
  EXPECT_TRUE(broken.blocks[0].breaks.empty());
  ASSERT_EQ(broken.blocks[1].breaks.size(), 1U);
  EXPECT_EQ(broken.blocks[1].navigated.constant_velocity, 3.0);
  const auto told = std::count_if(broken.not_tested.begin(), broken.not_tested.end(), [](const std::string& sentence) {
    return sentence.starts_with("Block B2 may be broken at scan 17: 80 scans without a match in the map, 2.0 s.");
  });
  EXPECT_EQ(told, 1);
  EXPECT_EQ(broken.not_tested.size(), sound.not_tested.size() + 1);
}

TEST(CertifyTest, StatesTheFeaturesAndJudgesByTheWorstTest) {
  const Certificate c = Certify(Input());
  EXPECT_EQ(c.statement.tested_on, "check features");
  EXPECT_EQ(c.statement.num_points, 3);
  EXPECT_TRUE(c.features_test.verdict->meets);
  EXPECT_FALSE(*c.statement.meets);  // the check point does not
  CertifyInput without_features = Input();
  without_features.reference_features.clear();
  EXPECT_EQ(Certify(without_features).statement.tested_on, "check points");
}

TEST(CertifyTest, BlocksInTheirLocalFrameAreNeverTested) {
  Certificate c = Certify(Input());
  EXPECT_FALSE(c.blocks[2].tied);
  for (const TestedCheck& check : c.checks) EXPECT_NE(check.block, "B3");
  EXPECT_NE(c.not_tested.front().find("B3 is not tied to control"), std::string::npos);
  CertifyInput only_loose = Input();
  only_loose.blocks.erase(only_loose.blocks.begin(), only_loose.blocks.begin() + 2);
  c = Certify(only_loose);
  EXPECT_FALSE(c.tied);
  EXPECT_TRUE(c.statement.asprs.empty());
  EXPECT_FALSE(c.statement.meets.has_value());
}

TEST(CertifyTest, NothingToTest) {
  CertifyInput input = Input();
  input.reference_features.clear();
  input.blocks[0].solution.marks.pop_back();
  const Certificate c = Certify(input);
  EXPECT_EQ(c.statement.tested_on, "nothing");
  EXPECT_NE(c.statement.asprs.find("produced to meet"), std::string::npos);
  EXPECT_FALSE(c.statement.meets.has_value());
  EXPECT_EQ(c.not_tested.size(), 7U);  // B1, B2, B3, K1, K2, walls, heights
}

// Control against all other control: a level of its own, by hand; the point that is marked twice does not count.
TEST(CertifyTest, CrossValidatesControl) {
  CertifyInput input = Input();
  EXPECT_FALSE(Certify(input).cross_validation);  // nothing controls two marks
  input.reference_features.clear();
  Solution& solution = input.blocks[0].solution;
  solution.marks.pop_back();  // the check point
  const MarkTest test{.redundancy = 0.4, .detectable = 0.03, .left_out_covariance = kSurvey};
  for (SolvedMark& mark : solution.marks) mark.test = test;
  solution.marks[0].test->left_out = {0.003, 0.004};
  solution.marks[1].test->left_out = {0.001, 0.0};
  solution.marks.push_back(solution.marks[1]);  // C2 again
  const Certificate c = Certify(input);
  ASSERT_TRUE(c.cross_validation);
  EXPECT_EQ(c.cross_validation->statistics.num_errors, 1);
  EXPECT_NEAR(c.cross_validation->statistics.rmse, 0.005, 1e-12);
  EXPECT_NEAR(c.cross_validation->statistics.rmse_survey, std::sqrt(8e-6), 1e-12);
  EXPECT_NEAR(c.cross_validation->normalised_square.value(), 25.0 / 4.0 / 2.0, 1e-9);
  EXPECT_NE(c.cross_validation->sentence.find("not tested: 1 control point"), std::string::npos);
  EXPECT_EQ(c.statement.tested_on, "nothing");
  EXPECT_FALSE(c.statement.meets.has_value());
}

TEST(CertifyTest, ListsWhatWasNotFound) {
  const Certificate c = Certify(Input());
  EXPECT_NE(std::find(c.not_tested.begin(), c.not_tested.end(), "Check point K2 was not occupied in any tied block."),
            c.not_tested.end());
}

TEST(CertifyTest, FeaturesThatAMapDoesNotShowAreNoZeros) {
  CertifyInput input = Input();
  for (CertifiedBlock& block : input.blocks) {
    block.features.clear();
    block.features.push_back({.name = "F1", .reason = "hidden"});
  }
  const Certificate c = Certify(input);
  EXPECT_EQ(c.features_test.statistics.num_points, 0);
  EXPECT_TRUE(c.stitching.pairs.empty());
  EXPECT_NE(std::find(c.not_tested.begin(), c.not_tested.end(),
                      "Check feature F1 was not found in the map of any tied block (B1: hidden)."),
            c.not_tested.end());
  EXPECT_NE(std::find(c.not_tested.begin(), c.not_tested.end(),
                      "Block B2: 0 of 1 check features could be read in its map; the others were not tested there."),
            c.not_tested.end());
}

TEST(CertifyTest, FindsChecksThatAreControl) {
  EXPECT_TRUE(FindContradictions(Input()).empty());
  CertifyInput used = Input();
  used.blocks[0].solution.marks[2].used = true;
  ASSERT_EQ(FindContradictions(used).size(), 1U);
  EXPECT_NE(FindContradictions(used)[0].find("point K1 was used as control in the solution of block B1"),
            std::string::npos);
  CertifyInput feature = Input();
  feature.reference_features.push_back(Surveyed("C1", {0, 0}));
  EXPECT_NE(FindContradictions(feature).at(0).find("check feature C1 bears the name"), std::string::npos);
  CertifyInput twice = Input();
  twice.reference_features.push_back(twice.reference_features[0]);
  EXPECT_EQ(FindContradictions(twice).at(0), "feature F1 is listed twice");
  CertifyInput exchanged = Input();
  for (NamedFeature& each : exchanged.reference_features) each.position_in_site += Eigen::Vector2d(5100000, -5100000);
  ASSERT_EQ(FindContradictions(exchanged).size(), 1U);
  EXPECT_NE(FindContradictions(exchanged)[0].find("lie 7212 km from all control, F1 the first of them"),
            std::string::npos);
  CertifyInput frames = Input();
  frames.network.frame.crs = "EPSG:25833";
  EXPECT_EQ(FindContradictions(frames).size(), 2U);
}

}  // namespace
}  // namespace survey
