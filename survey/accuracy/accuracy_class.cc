// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/accuracy_class.h"

namespace survey {
namespace {

struct Estimate {
  double value = 0.0;
  std::optional<double> upper_95;
};

// A length that grows with the errors: its bound is as far above it as that of their RMSE.
Estimate Scaled(double value, const ErrorStatistics& s) {
  if (!s.rmse_upper_95) return {value, std::nullopt};
  return {value, s.rmse > 0.0 ? value * *s.rmse_upper_95 / s.rmse : 0.0};
}

// Each axis has its bound; that both hold the class is shown when both bounds do.
Estimate LargerAxis(const ErrorStatistics& s) {
  const double value = s.rmse_by_axis.maxCoeff();
  if (s.num_independent < 2) return {value, std::nullopt};
  return {value, RmseUpper95(value, s.num_independent)};
}

Estimate Evaluate(ClassStatistic statistic, const ErrorStatistics& s) {
  switch (statistic) {
    case ClassStatistic::kRmseHorizontal:
      return {s.rmse_product, s.rmse_product_upper_95};
    case ClassStatistic::kRmseAxis:
      return LargerAxis(s);
    case ClassStatistic::kCircle95:
      return Scaled(s.ce95.value_or(s.nssda_95), s);
    case ClassStatistic::kNssda95:
      return Scaled(s.nssda_95, s);
  }
  return {};
}

}  // namespace

std::vector<ClassResult> JudgeClasses(const ErrorStatistics& statistics, std::span<const AccuracyClass> classes) {
  std::vector<ClassResult> results;
  if (statistics.num_points == 0) return results;
  for (const AccuracyClass& each : classes) {
    const Estimate estimate = Evaluate(each.statistic, statistics);
    results.push_back({.accuracy_class = each,
                       .value_m = estimate.value,
                       .upper_95 = estimate.upper_95,
                       .meets = estimate.value <= each.limit_m,
                       .demonstrated = estimate.upper_95 && *estimate.upper_95 <= each.limit_m});
  }
  return results;
}

}  // namespace survey
