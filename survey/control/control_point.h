// SPDX-License-Identifier: Apache-2.0
//
// Points of the control network. Site frame: x east, y north (m), right-handed, seen from above; heights up.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace survey {

// One role per run, fixed before the solution. control: ties the map; check: tests it and never enters `adjust`;
// tie: known by name only, several marks on it are one place; excluded: kept in the file with its reason, not used.
enum class PointRole { kControl, kCheck, kTie, kExcluded };

constexpr std::string_view Name(PointRole role) {
  switch (role) {
    case PointRole::kControl:
      return "control";
    case PointRole::kCheck:
      return "check";
    case PointRole::kTie:
      return "tie";
    case PointRole::kExcluded:
      return "excluded";
  }
  return "";
}

struct ControlPoint {
  std::string name;
  PointRole role = PointRole::kControl;
  Eigen::Vector2d position_in_site = Eigen::Vector2d::Zero();  // east, north (m)
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();        // m2, same order
  std::optional<double> elevation_m;
  std::string description;
  std::string reason;  // why excluded
};

// The coordinate system of a site. wkt2 is empty for the control's own plane (an engineering CRS).
struct SiteFrame {
  std::string crs;  // as the user wrote it: "EPSG:25832", or empty
  std::string wkt2;
};

struct ControlNetwork {
  SiteFrame frame;
  std::vector<ControlPoint> points;  // in order of their names
};

}  // namespace survey
