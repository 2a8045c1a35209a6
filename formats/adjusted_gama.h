// SPDX-License-Identifier: Apache-2.0
//
// GNU Gama's adjustment output (XML): coordinates with their covariance, the best carrier of control that another
// office has adjusted [Gama, "XML adjustment output"].
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace formats {

struct AdjustedPoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // east, north, height (m)
  bool has_plane = false;
  bool has_height = false;
  bool fixed = false;  // not adjusted: no covariance
};

struct AdjustedNetworkFile {
  std::string description;
  std::vector<AdjustedPoint> points;  // fixed ones first, then in the file's order
  Eigen::MatrixXd covariance;         // three rows for each point, m2; zero for what is not adjusted
  double sigma_zero_a_priori = 0.0;
  double sigma_zero_a_posteriori = 0.0;
  bool sigma_used_is_a_posteriori = false;  // in the covariance
  int degrees_of_freedom = 0;
  int num_observations = 0;
  int num_unknowns = 0;
  int defect = 0;
  double confidence = 0.95;
  std::string software;  // "GNU Gama 2.11"
  std::vector<std::string> warnings;
};

// DataError names file, line, value and rule.
AdjustedNetworkFile ReadGamaAdjustment(const std::filesystem::path& file);

// Which site component (0 east, 1 north) an axis letter of Gama's axes-xy means, with its sign: 'w' is -east.
struct PlaneAxis {
  int component = 0;
  double sign = 1.0;
};
// Both axes of "ne", "sw" and so on; false when it is no such pair.
bool ParsePlaneAxes(const std::string& axes_xy, PlaneAxis axes[2]);

}  // namespace formats
