// SPDX-License-Identifier: Apache-2.0
//
// Points of the control network. Site frame: x east, y north (m), right-handed, seen from above; heights up.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "survey/control/adjustment_summary.h"

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
  std::optional<double> elevation_sigma_m;  // 1 sigma
  std::string description;
  std::string reason;  // why excluded
};

// Covariance between two points: rows east, north of `a`, columns those of `b`; m2.
struct PointCorrelation {
  int a = 0;  // indices of the points, a < b
  int b = 0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

// The coordinate system of a site. wkt2 is empty for the control's own plane (an engineering CRS).
struct SiteFrame {
  std::string crs;  // as the user wrote it: "EPSG:25832", or empty
  std::string wkt2;
};

struct ControlNetwork {
  SiteFrame frame;
  std::vector<ControlPoint> points;               // in order of their names
  std::vector<PointCorrelation> correlations;     // in order of a, b; pairs that are not here are independent
  std::optional<AdjustmentSummary> adjustment;    // of the observations behind the points
  std::vector<AdjustedObservation> observations;  // that were adjusted here
  std::vector<std::string> remarks;               // sentences on how the coordinates came into the site's system
};

}  // namespace survey
