// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/error_statistics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "survey/accuracy/circular_error.h"
#include "survey/accuracy/distributions.h"

namespace survey {
namespace {

constexpr double kNmadFactor = 1.4826;         // 1 / normal quantile of 0.75
constexpr double kBlunderFactor = 3.0;         // [ASPRS24] section 7.2
constexpr double kLargestBiasFraction = 0.25;  // [ASPRS24] section 7.2

int NumPoints(std::span<const PositionError> errors) {
  std::set<int> points;
  for (const PositionError& error : errors) points.insert(error.point);
  return static_cast<int>(points.size());
}

Eigen::Matrix2d SecondMoment(std::span<const PositionError> errors) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const PositionError& error : errors) sum += error.error * error.error.transpose();
  return sum / static_cast<double>(errors.size());
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double Nmad(std::vector<double> values) {
  const double median = Median(values);
  for (double& value : values) value = std::abs(value - median);
  return kNmadFactor * Median(std::move(values));
}

Eigen::Vector2d NmadByAxis(std::span<const PositionError> errors) {
  std::vector<double> east, north;
  for (const PositionError& error : errors) {
    east.push_back(error.error.x());
    north.push_back(error.error.y());
  }
  return {Nmad(std::move(east)), Nmad(std::move(north))};
}

// T2 = n m' S^-1 m; F = T2 (n-2) / (2 (n-1)) has (2, n-2) degrees of freedom.
std::optional<BiasTest> HotellingTest(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance, int n) {
  if (n < 3 || covariance.determinant() <= 1e-12 * covariance.trace() * covariance.trace()) return std::nullopt;
  const double t_squared = n * mean.dot(covariance.inverse() * mean);
  return BiasTest{t_squared, FisherUpperTail(t_squared * (n - 2) / (2.0 * (n - 1)), 2.0, n - 2.0)};
}

// Of a bias along east and of one along north. The inverse of a sample covariance is on average (n-1)/(n-4) times the
// true one.
std::optional<Eigen::Vector2d> PowerOfBiasTest(const ErrorStatistics& statistics, double bias_m) {
  const int n = statistics.num_points;
  if (!statistics.bias || n < 5) return std::nullopt;
  const Eigen::Matrix2d inverse = statistics.covariance->inverse();
  const Eigen::Vector2d weights = inverse.diagonal() * (n - 4.0) / (n - 1.0);
  const double critical = FisherQuantile(0.95, 2.0, n - 2.0);
  const auto power = [&](double weight) {
    return NonCentralFisherUpperTail(critical, 2.0, n - 2.0, n * bias_m * bias_m * weight);
  };
  return Eigen::Vector2d(power(weights.x()), power(weights.y()));
}

void AddSpread(std::span<const PositionError> errors, ErrorStatistics* statistics) {
  const auto n = static_cast<double>(errors.size());
  const Eigen::Matrix2d second_moment = SecondMoment(errors);
  const Eigen::Matrix2d about_mean = second_moment - statistics->mean * statistics->mean.transpose();
  statistics->covariance = about_mean * n / (n - 1.0);
  statistics->nmad = NmadByAxis(errors);
  statistics->ce95 = CircularError(0.95, statistics->mean, *statistics->covariance);
  if (statistics->num_independent < 2) return;
  statistics->effective_dof = EffectiveDof(second_moment, statistics->num_independent);
  statistics->rmse_bounds_95 = RmseBounds95(statistics->rmse, *statistics->effective_dof);
  statistics->rmse_upper_95 = RmseUpper95(statistics->rmse, *statistics->effective_dof);
  statistics->rmse_product_upper_95 = std::hypot(*statistics->rmse_upper_95, statistics->rmse_survey);
  statistics->bias = HotellingTest(statistics->mean, *statistics->covariance, statistics->num_points);
}

}  // namespace

double EffectiveDof(const Eigen::Matrix2d& second_moment, int count) {
  const double trace = second_moment.trace();
  const double squares = second_moment.squaredNorm();  // l1^2 + l2^2 of a symmetric matrix
  return squares > 0.0 ? count * trace * trace / squares : 2.0 * count;
}

Bounds RmseBounds95(double rmse, double effective_dof) {
  return {rmse * std::sqrt(effective_dof / ChiSquareQuantile(0.975, effective_dof)),
          rmse * std::sqrt(effective_dof / ChiSquareQuantile(0.025, effective_dof))};
}

double RmseUpper95(double rmse, double effective_dof) {
  return rmse * std::sqrt(effective_dof / ChiSquareQuantile(0.05, effective_dof));
}

ErrorStatistics Summarize(std::span<const PositionError> errors, std::optional<int> num_independent) {
  ErrorStatistics statistics;
  if (errors.empty()) return statistics;
  statistics.num_errors = static_cast<int>(errors.size());
  statistics.num_points = NumPoints(errors);
  statistics.num_independent = num_independent.value_or(statistics.num_points);
  double survey_variance = 0.0;
  std::vector<double> lengths;
  for (const PositionError& error : errors) {
    statistics.mean += error.error;
    survey_variance += error.reference_covariance.trace();
    lengths.push_back(error.error.norm());
    statistics.max = std::max(statistics.max, lengths.back());
  }
  const auto n = static_cast<double>(errors.size());
  statistics.mean /= n;
  statistics.rmse_by_axis = SecondMoment(errors).diagonal().cwiseSqrt();
  statistics.rmse = statistics.rmse_by_axis.norm();
  statistics.rmse_survey = std::sqrt(survey_variance / n);
  statistics.rmse_product = std::hypot(statistics.rmse, statistics.rmse_survey);
  statistics.nssda_95 = kNssdaFactor * statistics.rmse;
  statistics.length_68 = EstimateQuantile(lengths, 0.683);
  statistics.length_95 = EstimateQuantile(lengths, 0.95);
  if (errors.size() >= 2) AddSpread(errors, &statistics);
  return statistics;
}

std::optional<ClassVerdict> JudgeClass(std::span<const PositionError> errors, const ErrorStatistics& statistics,
                                       double class_m) {
  if (errors.empty()) return std::nullopt;
  const double class_per_axis = class_m / std::sqrt(2.0);
  ClassVerdict verdict{.class_m = class_m};
  verdict.meets = statistics.rmse_product <= class_m;
  verdict.demonstrated = statistics.rmse_product_upper_95 && *statistics.rmse_product_upper_95 <= class_m;
  verdict.bias_within = statistics.mean.cwiseAbs().maxCoeff() <= kLargestBiasFraction * class_per_axis;
  verdict.bias_power = PowerOfBiasTest(statistics, kLargestBiasFraction * class_per_axis);
  std::set<int> beyond;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Eigen::Vector2d& error = errors[i].error;
    if (error.cwiseAbs().maxCoeff() > kBlunderFactor * class_per_axis) verdict.blunders.push_back(static_cast<int>(i));
    if (error.norm() > kNssdaFactor * class_m) beyond.insert(errors[i].point);
  }
  verdict.num_beyond_95 = static_cast<int>(beyond.size());
  verdict.largest_rate_beyond_95 = LargestRate(verdict.num_beyond_95, statistics.num_points, 0.95);
  return verdict;
}

}  // namespace survey
