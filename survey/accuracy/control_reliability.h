// SPDX-License-Identifier: Apache-2.0
//
// What the certificate says of the control itself: how well each mark is controlled by the others, and what was left
// out. Lengths in metres, site frame.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "survey/graph/solution.h"

namespace survey {

struct MarkReliability {
  std::string point;
  bool used = false;
  double redundancy = 0.0;  // 0 to 1
  double t = 0.0;
  std::optional<double> detectable;                  // smallest error that the test finds; empty: none however large
  std::optional<double> largest_shift;               // of the map by an error of that size
  std::optional<Eigen::Vector2d> left_out_residual;  // place by the others minus given: cross-validated
  std::optional<Eigen::Matrix2d> left_out_covariance;
  std::string left_out;  // why it took no part; empty: it did
};

struct BlockReliability {
  std::string block;
  ControlVerdict verdict;
  std::vector<VarianceComponent> components;
  std::vector<MarkReliability> marks;
  std::vector<std::string> findings;  // for people
};

// Of a tied block; without marks when one control point alone tied it.
BlockReliability ReliabilityOf(const std::string& block, const Solution& solution);

}  // namespace survey
