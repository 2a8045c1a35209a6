// SPDX-License-Identifier: Apache-2.0
//
// First and second moments of plane vectors.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>
#include <span>

namespace survey {

inline Eigen::Vector2d MeanOf(std::span<const Eigen::Vector2d> values) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& value : values) sum += value;
  return values.empty() ? sum : Eigen::Vector2d(sum / static_cast<double>(values.size()));
}

// (1/n) sum (v - mean)(v - mean)'.
inline Eigen::Matrix2d SecondMomentAboutMean(std::span<const Eigen::Vector2d> values) {
  const Eigen::Vector2d mean = MeanOf(values);
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& value : values) sum += (value - mean) * (value - mean).transpose();
  return values.empty() ? sum : Eigen::Matrix2d(sum / static_cast<double>(values.size()));
}

// Empty when the values do not spread in two directions.
inline std::optional<Eigen::Matrix2d> InverseOfSpread(const Eigen::Matrix2d& spread) {
  if (!(spread.determinant() > 1e-12 * spread.trace() * spread.trace())) return std::nullopt;
  return spread.inverse();
}

}  // namespace survey
