// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/earth.h"

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/Ellipsoid.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <cmath>
#include <numbers>

namespace survey {

Earth EarthAt(double latitude_rad, double height_m) {
  using GeographicLib::Ellipsoid;
  const double degrees = latitude_rad * 180.0 / std::numbers::pi;
  Earth earth;
  earth.rotation_in_nav = GeographicLib::Constants::WGS84_omega<double>() *
                          Eigen::Vector3d(0.0, std::cos(latitude_rad), std::sin(latitude_rad));
  double north = 0.0;
  double up = 0.0;
  GeographicLib::NormalGravity::WGS84().Gravity(degrees, height_m, north, up);
  earth.gravity_in_nav = {0.0, north, up};
  earth.meridian_radius_m = Ellipsoid::WGS84().MeridionalCurvatureRadius(degrees) + height_m;
  earth.transverse_radius_m = Ellipsoid::WGS84().TransverseCurvatureRadius(degrees) + height_m;
  earth.tan_latitude = std::tan(latitude_rad);
  return earth;
}

Eigen::Vector3d TransportRate(const Earth& earth, const Eigen::Vector3d& v_in_nav) {
  const double about_north = v_in_nav.x() / earth.transverse_radius_m;
  return {-v_in_nav.y() / earth.meridian_radius_m, about_north, about_north * earth.tan_latitude};
}

}  // namespace survey
