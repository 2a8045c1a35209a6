// SPDX-License-Identifier: Apache-2.0
//
// Accuracy classes of standards and contracts, and what the errors of a test say about them. The same "15 mm" is
// another requirement in each: a class carries its statistic and its confidence level.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "survey/accuracy/error_statistics.h"

namespace survey {

enum class ClassStatistic {
  kRmseHorizontal,  // [ASPRS24] RMSE_H, both axes with the survey error of the checks
  kRmseAxis,        // the larger of RMSE_x and RMSE_y: a standard deviation from the true value
  kCircle95,        // CE95: radius that holds 95 % of the errors, from their mean and covariance
  kNssda95          // 1.7308 RMSE_H1
};

constexpr std::string_view Name(ClassStatistic statistic) {
  switch (statistic) {
    case ClassStatistic::kRmseHorizontal:
      return "rmse-h";
    case ClassStatistic::kRmseAxis:
      return "rmse-axis";
    case ClassStatistic::kCircle95:
      return "ce95";
    case ClassStatistic::kNssda95:
      return "nssda-95";
  }
  return "";
}

struct AccuracyClass {
  std::string standard;  // "DIN 18710-1"
  std::string name;      // "OGL2"
  std::string source;    // where the limit is printed
  ClassStatistic statistic = ClassStatistic::kRmseHorizontal;
  double confidence = 0.0;  // share of errors that the limit is meant to hold, for people: 0.95; 0.6827 is one sigma
  double limit_m = 0.0;
};

// `meets` and `demonstrated` are two claims and never merged.
struct ClassResult {
  AccuracyClass accuracy_class;
  double value_m = 0.0;            // of the statistic
  std::optional<double> upper_95;  // its one-sided 95 % bound, m
  bool meets = false;              // value <= limit
  bool demonstrated = false;       // bound <= limit
};

// Results in the order of the classes; none without errors.
std::vector<ClassResult> JudgeClasses(const ErrorStatistics& statistics, std::span<const AccuracyClass> classes);

}  // namespace survey
