// SPDX-License-Identifier: Apache-2.0
//
// One observation as a function of the coordinates, with its analytic derivatives. With the vector d = (east, north,
// up) from instrument to target in the station's levelled frame and h = sqrt(east2 + north2) [Ghilani17 chapters
// 14-16]:
//   azimuth atan2(east, north); direction = azimuth - orientation of its set; angle = azimuth fore - azimuth back;
//   distance h; slope distance |d|; zenith angle atan2(h, up); differences and coordinates by component.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "survey/network/network.h"

namespace survey {

struct ObservationEquation {
  double computed = 0.0;                       // m or rad, angles in no particular turn
  int num_points = 0;                          // that take part
  std::array<int, 3> points{};                 // their indices
  std::array<Eigen::RowVector3d, 3> partials;  // d computed / d position of the point
  double orientation_partial = 0.0;            // d computed / d orientation of its set
};

// `orientation` of the direction's set (rad), unused else. Precondition: the points' coordinates are known and apart.
ObservationEquation Evaluate(const Observation& observation, const std::vector<Eigen::Vector3d>& positions,
                             double orientation, const NetworkGeometry& geometry);

// Observed minus computed, angles in (-pi, pi].
double Misclosure(const Observation& observation, double computed);

// Rows: east, north, up of the levelled frame at a position of a geocentric network.
Eigen::Matrix3d LevelledAxes(const Eigen::Vector3d& position);

// Above the ellipsoid (GRS 80), m.
double EllipsoidalHeight(const Eigen::Vector3d& geocentric_position);

// The same angle in (-pi, pi].
double WrappedAngle(double angle_rad);

}  // namespace survey
