// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/error_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/stats/philox.h"

namespace survey {
namespace {

std::vector<PositionError> Errors(const std::vector<Eigen::Vector2d>& values) {
  std::vector<PositionError> errors;
  for (const Eigen::Vector2d& value : values)
    errors.push_back({.point = static_cast<int>(errors.size()), .error = value});
  return errors;
}

// Normal errors of one simulated test.
std::vector<PositionError> Draw(int n, double sigma_e, double sigma_n, const Eigen::Vector2d& bias, int set) {
  const RandomStream random(7, 1, static_cast<std::uint32_t>(set));
  std::vector<PositionError> errors;
  for (int i = 0; i < n; ++i) {
    const auto [e, u] = random.Normals(static_cast<std::uint64_t>(i));
    errors.push_back({.point = i, .error = bias + Eigen::Vector2d(sigma_e * e, sigma_n * u)});
  }
  return errors;
}

// By hand: errors (3, 0), (-1, 2), (1, -2), (1, 4): mean (1, 1); sums of squares 12 and 24.
TEST(ErrorStatisticsTest, HandComputed) {
  std::vector<PositionError> errors = Errors({{3, 0}, {-1, 2}, {1, -2}, {1, 4}});
  for (PositionError& error : errors) error.reference_covariance = Eigen::Matrix2d::Identity() * 2.0;
  const ErrorStatistics s = Summarize(errors);
  EXPECT_EQ(s.num_errors, 4);
  EXPECT_EQ(s.num_points, 4);
  EXPECT_EQ(s.mean, Eigen::Vector2d(1, 1));
  EXPECT_DOUBLE_EQ(s.rmse_by_axis.x(), std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(s.rmse_by_axis.y(), std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(s.rmse, 3.0);
  EXPECT_DOUBLE_EQ(s.rmse_survey, 2.0);
  EXPECT_DOUBLE_EQ(s.rmse_product, std::sqrt(13.0));
  EXPECT_DOUBLE_EQ(s.max, std::sqrt(17.0));
  EXPECT_DOUBLE_EQ(s.nssda_95, 1.7308 * 3.0);
  // (1/3) sum (d - m)(d - m)': e 8/3, n 20/3, en: (2*-1) + (-2*1) + 0 + 0 = -4 -> -4/3.
  EXPECT_TRUE(s.covariance->isApprox((Eigen::Matrix2d() << 8, -4, -4, 20).finished() / 3.0));
  // e: 3 -1 1 1, median 1, deviations 2 2 0 0; n: 0 2 -2 4, median 1, deviations 1 1 3 3.
  EXPECT_NEAR(s.nmad->x(), 1.4826 * 1.0, 1e-12);
  EXPECT_NEAR(s.nmad->y(), 1.4826 * 2.0, 1e-12);
  // second moments: 3, 6, en (0 - 2 - 2 + 4) / 4 = 0: nu = 4 * 81 / 45.
  EXPECT_NEAR(*s.effective_dof, 7.2, 1e-12);
  // T2 = 4 m' S^-1 m, S^-1 = 3/144 (20 4; 4 8), sum of its entries 0.75: T2 = 3, F = 3 * 2 / 6 = 1; F(2,2): p = 1/2.
  EXPECT_NEAR(s.bias->t_squared, 3.0, 1e-12);
  EXPECT_NEAR(s.bias->p_value, 0.5, 1e-12);
}

// [ASPRS24] table 7.4: a fit of 1.00 cm with check points of 2.0 cm gives 2.24 cm.
TEST(ErrorStatisticsTest, SurveyErrorEntersTheProduct) {
  std::vector<PositionError> errors = Errors({{0.01, 0}, {0, -0.01}});
  for (PositionError& error : errors) error.reference_covariance = Eigen::Matrix2d::Identity() * 0.0002;
  EXPECT_NEAR(Summarize(errors).rmse_product, 0.0224, 5e-5);
}

// Factors on RMSE_H of n isotropic errors: two-sided 95 % and one-sided upper 95 %.
TEST(ErrorStatisticsTest, SampleSizeFactors) {
  struct Factors {
    int n;
    double low, high, upper;
  };
  for (const Factors& f :
       {Factors{3, 0.64, 2.20, 1.92}, Factors{5, 0.70, 1.76, 1.59}, Factors{8, 0.75, 1.52, 1.42},
        Factors{10, 0.77, 1.44, 1.36}, Factors{15, 0.80, 1.34, 1.27}, Factors{20, 0.82, 1.28, 1.23},
        Factors{30, 0.85, 1.22, 1.18}, Factors{60, 0.89, 1.15, 1.12}, Factors{120, 0.92, 1.10, 1.08}}) {
    const double nu = EffectiveDof(Eigen::Matrix2d::Identity(), f.n);
    EXPECT_DOUBLE_EQ(nu, 2.0 * f.n);
    EXPECT_NEAR(RmseBounds95(1.0, nu).low, f.low, 0.0055) << f.n;
    EXPECT_NEAR(RmseBounds95(1.0, nu).high, f.high, 0.0055) << f.n;
    EXPECT_NEAR(RmseUpper95(1.0, nu), f.upper, 0.0055) << f.n;
  }
  const Eigen::Matrix2d corridor = Eigen::Vector2d(1, 0).asDiagonal();
  EXPECT_NEAR(RmseUpper95(1.0, EffectiveDof(corridor, 10)), 1.59, 0.0055);
  EXPECT_NEAR(RmseUpper95(1.0, EffectiveDof(corridor, 30)), 1.27, 0.0055);
}

TEST(ErrorStatisticsTest, NoneAndOne) {
  const ErrorStatistics none = Summarize({});
  EXPECT_EQ(none.num_points, 0);
  EXPECT_FALSE(JudgeClass({}, Summarize({}), 0.05).has_value());
  const std::vector<PositionError> errors = Errors({{0.03, 0.04}});
  const ErrorStatistics one = Summarize(errors);
  EXPECT_DOUBLE_EQ(one.rmse, 0.05);
  EXPECT_FALSE(one.rmse_upper_95 || one.covariance || one.bias || one.ce95);
  const std::optional<ClassVerdict> verdict = JudgeClass(errors, one, 0.1);
  EXPECT_TRUE(verdict->meets);
  EXPECT_FALSE(verdict->demonstrated);
}

TEST(ErrorStatisticsTest, ErrorsAtOnePointAreNotIndependent) {
  std::vector<PositionError> errors = Errors({{0.01, 0.01}, {0.01, -0.01}, {-0.01, 0.01}, {-0.01, -0.01}});
  EXPECT_NEAR(*Summarize(errors).effective_dof, 8.0, 1e-9);
  errors[3].point = errors[2].point = 0;
  EXPECT_EQ(Summarize(errors).num_points, 2);
  EXPECT_NEAR(*Summarize(errors).effective_dof, 4.0, 1e-9);
  for (PositionError& error : errors) error.point = 0;
  EXPECT_FALSE(Summarize(errors).rmse_upper_95.has_value());
}

TEST(ErrorStatisticsTest, ZeroErrorsAreNoTrouble) {
  const ErrorStatistics s = Summarize(Errors({{0, 0}, {0, 0}, {0, 0}}));
  EXPECT_EQ(s.rmse, 0.0);
  EXPECT_EQ(*s.rmse_upper_95, 0.0);
  EXPECT_EQ(*s.ce95, 0.0);
  EXPECT_FALSE(s.bias.has_value());
}

TEST(ErrorStatisticsTest, FlagsBlundersAndCountsTheRate) {
  const std::vector<PositionError> errors = Errors({{0.01, 0}, {0.11, 0}, {0, -0.09}, {0.02, 0.02}});
  const std::optional<ClassVerdict> verdict =
      JudgeClass(errors, Summarize(errors), 0.05);  // 3 C / sqrt 2 = 0.106; 1.7308 C = 0.0865
  EXPECT_EQ(verdict->blunders, std::vector<int>{1});
  EXPECT_EQ(verdict->num_beyond_95, 2);
  EXPECT_FALSE(verdict->meets);
  EXPECT_FALSE(verdict->bias_within);
}

// Over many simulated tests the bounds must hold as often as they claim, for round and for long error ellipses.
TEST(ErrorStatisticsTest, BoundsCoverTheTruth) {
  constexpr int kSets = 1000;
  for (const double ratio : {1.0, 0.5, 0.1}) {
    const double truth = std::hypot(0.03, 0.03 * ratio);
    int two_sided = 0, one_sided = 0, falsely_demonstrated = 0;
    for (int set = 0; set < kSets; ++set) {
      const std::vector<PositionError> errors = Draw(20, 0.03, 0.03 * ratio, Eigen::Vector2d::Zero(), set);
      const ErrorStatistics s = Summarize(errors);
      two_sided += s.rmse_bounds_95->low <= truth && truth <= s.rmse_bounds_95->high ? 1 : 0;
      one_sided += truth <= *s.rmse_upper_95 ? 1 : 0;
      falsely_demonstrated += JudgeClass(errors, s, truth * 0.9999)->demonstrated ? 1 : 0;
    }
    EXPECT_GE(two_sided, 0.93 * kSets) << ratio;
    EXPECT_LE(two_sided, 0.97 * kSets) << ratio;
    EXPECT_GE(one_sided, 0.93 * kSets) << ratio;
    EXPECT_LE(one_sided, 0.97 * kSets) << ratio;
    EXPECT_LE(falsely_demonstrated, 0.065 * kSets) << ratio;
  }
}

TEST(ErrorStatisticsTest, BiasTestHoldsItsLevelAndFindsABias) {
  constexpr int kSets = 1000;
  int false_alarms = 0, found = 0;
  for (int set = 0; set < kSets; ++set) {
    false_alarms += Summarize(Draw(20, 0.03, 0.01, Eigen::Vector2d::Zero(), set)).bias->p_value < 0.05 ? 1 : 0;
    found += Summarize(Draw(20, 0.03, 0.01, {0.02, 0.01}, set)).bias->p_value < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(false_alarms, 0.05 * kSets, 28);  // four sigmas of the count
  EXPECT_GT(found, 0.99 * kSets);
}

// A bias of 25 % of the class along an axis is found as often as the certificates say.
TEST(ErrorStatisticsTest, BiasOfAQuarterOfTheClassIsFoundWithTheStatedPower) {
  constexpr int kSets = 1000;
  constexpr double kClass = 0.1;
  for (const auto& [n, sigma_n] : {std::pair{12, 0.03}, {20, 0.03}, {20, 0.01}, {60, 0.02}}) {
    int found = 0;
    double stated = 0.0;
    for (int set = 0; set < kSets; ++set) {
      const std::vector<PositionError> errors = Draw(n, 0.03, sigma_n, {0.25 * kClass / std::sqrt(2.0), 0.0}, set);
      const ErrorStatistics s = Summarize(errors);
      found += s.bias->p_value < 0.05 ? 1 : 0;
      stated += JudgeClass(errors, s, kClass)->bias_power->x();
    }
    EXPECT_NEAR(found, stated, 0.06 * kSets) << n << " " << sigma_n;
    EXPECT_GT(found, 0.2 * kSets);
  }
  const std::vector<PositionError> four = Draw(4, 0.03, 0.03, Eigen::Vector2d::Zero(), 1);
  EXPECT_FALSE(JudgeClass(four, Summarize(four), kClass)->bias_power);
}

}  // namespace
}  // namespace survey
