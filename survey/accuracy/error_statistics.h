// SPDX-License-Identifier: Apache-2.0
//
// Statistics of horizontal position errors d = map - reference (east, north; m) at check points: RMSE with its
// confidence bounds, circular errors, bias and spread. [ASPRS24] for RMSE_H and its parts, [NSSDA] for the 95 % figure.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "survey/accuracy/error_quantile.h"

namespace survey {

// Radius that holds 95 % of circular errors over their RMSE in one direction: 2.4477 / sqrt(2) [NSSDA].
inline constexpr double kNssdaFactor = 1.7308;

// One error at one check. Several errors may belong to one point (seen in two blocks, occupied twice): they are not
// independent, so the degrees of freedom count points.
struct PositionError {
  int point = 0;  // equal for errors at the same check point
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  Eigen::Matrix2d reference_covariance = Eigen::Matrix2d::Zero();  // survey of the check point and its picking, m2
};

struct Bounds {
  double low = 0.0;
  double high = 0.0;
};

// Hotelling's test of a mean error that is not zero.
struct BiasTest {
  double t_squared = 0.0;
  double p_value = 1.0;  // probability of such a mean without bias
};

struct ErrorStatistics {
  int num_errors = 0;
  int num_points = 0;                                      // distinct check points; everything below is zero without
  int num_independent = 0;                                 // of the bounds: points, or blocks where errors cluster
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();          // east, north
  Eigen::Vector2d rmse_by_axis = Eigen::Vector2d::Zero();  // RMSE_x, RMSE_y
  double rmse = 0.0;                                       // RMSE_H1 = sqrt(RMSE_x^2 + RMSE_y^2): the fit to the checks
  double rmse_survey = 0.0;                                // RMSE_H2: of the check points themselves
  double rmse_product = 0.0;                               // [ASPRS24] RMSE_H = sqrt(RMSE_H1^2 + RMSE_H2^2)
  double max = 0.0;                                        // longest error
  double nssda_95 = 0.0;                                   // 1.7308 RMSE_H1: circular error for equal axes
  QuantileEstimate length_68;                              // of the lengths of the errors, 68.3 % and 95 %
  QuantileEstimate length_95;

  // Two errors or more:
  std::optional<Eigen::Matrix2d> covariance;  // sample covariance about the mean, n - 1
  std::optional<Eigen::Vector2d> nmad;        // 1.4826 median |d - median d| by axis: spread that blunders spare
  std::optional<double> ce95;                 // radius that holds 95 % of N(mean, covariance), by quadrature
  // Two independent errors or more:
  std::optional<double> effective_dof;          // nu = n (l1+l2)^2 / (l1^2+l2^2), l of the second-moment matrix
  std::optional<Bounds> rmse_bounds_95;         // two-sided confidence interval of RMSE_H1
  std::optional<double> rmse_upper_95;          // one-sided upper bound of RMSE_H1
  std::optional<double> rmse_product_upper_95;  // the same of RMSE_H
  // Three points or more:
  std::optional<BiasTest> bias;
};

// `num_independent` replaces the number of points in the bounds where errors at several points are not independent.
ErrorStatistics Summarize(std::span<const PositionError> errors, std::optional<int> num_independent = {});

// What the errors say about a class given as RMSE_H. `meets` and `demonstrated` are two claims and never merged.
struct ClassVerdict {
  double class_m = 0.0;
  bool meets = false;         // RMSE_H <= class
  bool demonstrated = false;  // the one-sided 95 % bound of RMSE_H <= class
  bool bias_within = false;   // |mean| per axis <= 25 % of class / sqrt(2)
  // Probability that the bias test (5 %) finds a bias of that size, along east and along north; five points or more.
  std::optional<Eigen::Vector2d> bias_power;
  std::vector<int> blunders;  // indices of errors beyond 3 class / sqrt(2) in one axis; flagged, never dropped
  int num_beyond_95 = 0;      // points with an error longer than 1.7308 class
  double largest_rate_beyond_95 = 1.0;  // Clopper-Pearson, one-sided 95 %
};

// `statistics` are those of `errors`. Empty without errors. Precondition: class_m > 0.
std::optional<ClassVerdict> JudgeClass(std::span<const PositionError> errors, const ErrorStatistics& statistics,
                                       double class_m);

// nu and the bounds from the eigenvalues of a second-moment matrix, for `count` independent errors.
double EffectiveDof(const Eigen::Matrix2d& second_moment, int count);
Bounds RmseBounds95(double rmse, double effective_dof);
double RmseUpper95(double rmse, double effective_dof);

}  // namespace survey
