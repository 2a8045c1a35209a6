// SPDX-License-Identifier: Apache-2.0
//
// What the errors of one kind of check (points or features, over the whole site) say beyond their statistics: whether
// they are normal, which do not belong to the rest, whether they cluster, how the checks are spread, and the classes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "survey/accuracy/accuracy_class.h"
#include "survey/accuracy/check_spread.h"
#include "survey/accuracy/clustering.h"
#include "survey/accuracy/normality.h"

namespace survey {

struct CheckAnalysis {
  std::optional<NormalityTest> normality;
  int num_outliers = 0;  // by their distance from the other errors, whatever the class
  std::optional<BlockEffect> block_effect;
  std::optional<MoranTest> moran;
  std::optional<CheckSpread> spread;
  std::vector<ClassResult> classes;
};

// Significance below which errors count as clustered.
inline constexpr double kClustered = 0.05;

// An error with its place; several may lie at one point, which tests take together as their mean.
struct PlacedError {
  int point = 0;
  int block = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the check, site frame
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
};

// `outliers` receives indices of `errors`; spread and classes are left to the caller.
CheckAnalysis AnalyseErrors(std::span<const PlacedError> errors, std::vector<int>* outliers);

}  // namespace survey
