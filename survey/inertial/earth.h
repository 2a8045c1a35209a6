// SPDX-License-Identifier: Apache-2.0
//
// The Earth as an inertial unit feels it at one place: rotation, normal gravity and curvature of WGS 84.
// Navigation frame `nav`: east, north, up.
#pragma once

#include <Eigen/Core>

namespace survey {

struct Earth {
  Eigen::Vector3d rotation_in_nav = Eigen::Vector3d::Zero();  // rad/s
  Eigen::Vector3d gravity_in_nav = Eigen::Vector3d::Zero();   // m/s2, with the centrifugal part
  double meridian_radius_m = 0.0;                             // of curvature, at the height
  double transverse_radius_m = 0.0;                           // the same in the prime vertical
  double tan_latitude = 0.0;
};

// Latitude in radians, within +-90 degrees; height above the ellipsoid.
Earth EarthAt(double latitude_rad, double height_m);

// Rate at which the navigation frame turns over the Earth as it moves with v (m/s), rad/s.
Eigen::Vector3d TransportRate(const Earth& earth, const Eigen::Vector3d& v_in_nav);

}  // namespace survey
