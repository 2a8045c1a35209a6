// SPDX-License-Identifier: Apache-2.0
//
// Are position errors normal? Shapiro-Wilk by axis [Royston95] and Mardia's skewness and kurtosis of the pair
// [Mardia70]. Where they are not, circular errors from mean and covariance mislead and quantiles lead.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace survey {

struct ShapiroWilk {
  double w = 1.0;
  double p_value = 1.0;
};

// Three to 5000 values that are not all equal; else empty.
std::optional<ShapiroWilk> TestShapiroWilk(std::vector<double> values);

struct NormalityTest {
  Eigen::Vector2d w = Eigen::Vector2d::Ones();          // Shapiro-Wilk, east and north
  Eigen::Vector2d p_by_axis = Eigen::Vector2d::Ones();  // probability of such a W when normal
  double skewness = 0.0;                                // Mardia's b1; 0 when normal
  double skewness_p = 1.0;
  double kurtosis = 0.0;  // Mardia's b2; 8 (n-1)/(n+1) when normal
  double kurtosis_p = 1.0;

  bool Rejected() const;  // at 5 % in all, shared by the four tests (Bonferroni)
};

// Eight errors or more that spread in both axes; else empty.
std::optional<NormalityTest> TestNormality(std::span<const Eigen::Vector2d> errors);

}  // namespace survey
