// SPDX-License-Identifier: Apache-2.0
//
// Straight faces in a plane reference (points of a terrestrial scanner): most points within a tolerance [Fischler81],
// then total least squares on those that no other face could have drawn.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

namespace survey {

struct PointLineOptions {
  double tolerance_m = 0.008;  // of a point from its line
  int min_points = 12;
};

struct PointLine {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // of its points
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double half_length = 0.0;
  double spread = 0.0;        // rms distance of the points from the middle, along the line
  double sigma_offset = 0.0;  // standard deviation in the middle, m

  Eigen::Vector2d Along() const { return {-normal.y(), normal.x()}; }
  double DistanceTo(const Eigen::Vector2d& p) const { return std::abs(normal.dot(p - middle)); }
  bool ReachesTo(const Eigen::Vector2d& p, double gap_m) const {
    return std::abs(Along().dot(p - middle)) <= half_length + gap_m;
  }
  // Standard deviation of the offset beside p: the direction is uncertain too.
  double SigmaAt(const Eigen::Vector2d& p) const;
};

// The longest at first; at least 0.12 m long.
std::vector<PointLine> FindPointLines(const std::vector<Eigen::Vector2d>& points, const PointLineOptions& options);

struct PointCrossing {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

// Empty where the lines meet at less than 30 degrees.
std::optional<PointCrossing> CrossingOf(const PointLine& a, const PointLine& b);

}  // namespace survey
