// SPDX-License-Identifier: Apache-2.0
//
// Scan-to-map matching by Gauss-Newton on interpolated occupancy, [CN] eq. (6)-(7), with the predicted pose as a
// further observation, so that a direction that the scan does not see (along a corridor) keeps its prediction.
#pragma once

#include <Eigen/Core>
#include <span>

#include "survey/geometry/pose2.h"
#include "survey/grid/occupancy_pyramid.h"

namespace survey {

struct MatchOptions {
  int coarsest_level = 1;       // Gauss-Newton runs from this level of the pyramid down to level 0
  int max_iterations = 12;      // per level
  double residual_sigma = 0.5;  // of one end point's 1 - M: occupancy residuals of neighbouring beams are correlated
  double step_m = 2e-4;         // converged below this step
  double step_rad = 2e-5;
};

struct MatchResult {
  Pose2 map_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // x, y (m), theta (rad), in the map's axes
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();     // of the scan alone, without the prediction
  double score = 0.0;                                        // mean occupancy at the end points, 0..1
  bool usable = false;                                       // false: no points, or the normal equations are singular
};

// Prediction: map_from_scan as the motion model has it, with its covariance (map axes).
MatchResult MatchScan(const OccupancyPyramid& map, std::span<const Eigen::Vector2f> points_in_scan, const Pose2& start,
                      const Pose2& predicted, const Eigen::Matrix3d& prediction_covariance,
                      const MatchOptions& options);

// Cost of eq. (6) at one pose with its gradient and Gauss-Newton normal matrix, the prediction left out.
struct OccupancyCost {
  double cost = 0.0;       // half the sum of (1 - M)^2 / residual_sigma^2
  double occupancy = 0.0;  // sum of M
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
};
OccupancyCost EvaluateOccupancyCost(const OccupancyPyramid& map, int level,
                                    std::span<const Eigen::Vector2f> points_in_scan, const Pose2& map_from_scan,
                                    double residual_sigma);

// Mean occupancy of the cells of a level that hold the end points.
double MeanOccupancy(const OccupancyPyramid& map, int level, std::span<const Eigen::Vector2f> points_in_scan,
                     const Pose2& map_from_scan);

}  // namespace survey
