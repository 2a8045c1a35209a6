// SPDX-License-Identifier: Apache-2.0
//
// A site grid tied to the projected system by points that are known in both: shift and rotation (3 parameters), and
// scale (4 parameters), by least squares on equal weights [Ghilani17 chapter 18].
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace survey {

struct TiePoint {
  std::string name;
  Eigen::Vector2d in_grid = Eigen::Vector2d::Zero();       // x, y of the site grid, m
  Eigen::Vector2d in_projected = Eigen::Vector2d::Zero();  // east, north, m
};

// projected = origin + scale * R(rotation) * (grid - grid_origin); rotation counter-clockwise, rad.
struct SiteTie {
  bool usable = false;
  std::string message;
  Eigen::Vector2d grid_origin = Eigen::Vector2d::Zero();
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  double rotation = 0.0;
  int num_parameters = 4;
  double scale = 1.0;                      // applied: 1 with 3 parameters
  double fitted_scale = 1.0;               // of the 4-parameter fit, for information with 3 parameters
  std::vector<Eigen::Vector2d> residuals;  // transformed minus given, m, in the order of the points
  double sigma_zero = 0.0;                 // of one coordinate, m; 0 without redundancy
  int degrees_of_freedom = 0;

  Eigen::Vector2d Apply(const Eigen::Vector2d& in_grid) const;
  Eigen::Matrix2d Apply(const Eigen::Matrix2d& covariance_in_grid) const;
};

// Not usable with fewer than two points, with coincident points, or when the axes of one system are exchanged (the
// mirror image fits, the points do not).
SiteTie FitSiteTie(const std::vector<TiePoint>& points, bool with_scale);

}  // namespace survey
