// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/strapdown.h"

#include <GeographicLib/Constants.hpp>
#include <cmath>

namespace survey {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// What the products of the previous and this increment count, with rates that are linear over both: 1/12 for equal
// intervals; 0 without a previous one.
double SecondOrderWeight(const ImuIncrement& previous, const ImuIncrement& now) {
  if (!(previous.dt_s > 0.0)) return 0.0;
  return now.dt_s * now.dt_s / (6.0 * previous.dt_s * (previous.dt_s + now.dt_s));
}

}  // namespace

Quaterniond EcefFromNav(const GeodeticPlace& place) {
  const double slat = std::sin(place.latitude_rad);
  const double clat = std::cos(place.latitude_rad);
  const double slon = std::sin(place.longitude_rad);
  const double clon = std::cos(place.longitude_rad);
  Eigen::Matrix3d axes;  // columns: east, north, up
  axes << -slon, -slat * clon, clat * clon, clon, -slat * slon, clat * slon, 0.0, clat, slat;
  return Quaterniond(axes);
}

GeodeticPlace PlaceOf(const Quaterniond& ecef_from_nav) {
  const Vector3d up = ecef_from_nav * Vector3d::UnitZ();
  return {std::atan2(up.z(), std::hypot(up.x(), up.y())), std::atan2(up.y(), up.x())};
}

Quaterniond FromRotationVector(const Vector3d& rotation_vector) {
  const double half = 0.5 * rotation_vector.norm();
  // sin(h) / (2 h), by its series where the quotient loses digits.
  const double factor = half > 1e-4 ? 0.5 * std::sin(half) / half : 0.5 - half * half / 12.0;
  const Vector3d v = factor * rotation_vector;
  return {std::cos(half), v.x(), v.y(), v.z()};
}

Vector3d ToRotationVector(const Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double sine = rotation.vec().norm();
  const double angle = 2.0 * std::atan2(sine, std::abs(rotation.w()));
  return (sine > 1e-9 ? sign * angle / sine : sign * 2.0) * rotation.vec();
}

Vector3d VelocityGain(const Quaterniond& nav_from_body, const Vector3d& turn_of_nav, const ImuIncrement& previous,
                      const ImuIncrement& now) {
  const double weight = SecondOrderWeight(previous, now);
  const Vector3d turned = now.dtheta.cross(now.dvel);
  const Vector3d rotation = 0.5 * turned + now.dtheta.cross(turned) / 6.0;
  const Vector3d sculling = weight * (previous.dtheta.cross(now.dvel) + previous.dvel.cross(now.dtheta));
  const Vector3d gain = nav_from_body * (now.dvel + rotation + sculling);
  return gain - 0.5 * turn_of_nav.cross(gain);
}

Vector3d UpdateVelocity(const Vector3d& v_in_nav, const Vector3d& gain, const Earth& earth, const Vector3d& v_middle,
                        double dt_s) {
  const Vector3d turning = 2.0 * earth.rotation_in_nav + TransportRate(earth, v_middle);
  return v_in_nav + gain + dt_s * (earth.gravity_in_nav - turning.cross(v_middle));
}

Quaterniond UpdatePosition(const Quaterniond& ecef_from_nav, const Vector3d& turn_of_nav, double dt_s) {
  const Vector3d turn_of_earth(0.0, 0.0, dt_s * GeographicLib::Constants::WGS84_omega<double>());
  return (FromRotationVector(-turn_of_earth) * ecef_from_nav * FromRotationVector(turn_of_nav)).normalized();
}

Quaterniond UpdateAttitude(const Quaterniond& nav_from_body, const Vector3d& turn_of_nav, const ImuIncrement& previous,
                           const ImuIncrement& now) {
  const Vector3d coning = SecondOrderWeight(previous, now) * previous.dtheta.cross(now.dtheta);
  return (FromRotationVector(-turn_of_nav) * nav_from_body * FromRotationVector(now.dtheta + coning)).normalized();
}

NavState Mechanize(const NavState& state, const ImuIncrement& previous, const ImuIncrement& now) {
  const double dt = now.dt_s;
  // Half way: the place from the old velocity, the velocity from the forces of this increment.
  const double middle_height = state.height_m + 0.5 * dt * state.v_in_nav.z();
  const GeodeticPlace place = PlaceOf(state.ecef_from_nav);
  const Earth start = EarthAt(place.latitude_rad, state.height_m);
  const double middle_latitude = place.latitude_rad + 0.5 * dt * state.v_in_nav.y() / start.meridian_radius_m;
  const Earth earth = EarthAt(middle_latitude, middle_height);
  const auto turn_of_nav = [&](const Vector3d& v) -> Vector3d {
    return dt * (earth.rotation_in_nav + TransportRate(earth, v));
  };
  const Vector3d gain = VelocityGain(state.nav_from_body, turn_of_nav(state.v_in_nav), previous, now);
  const Vector3d v_middle = 0.5 * (state.v_in_nav + UpdateVelocity(state.v_in_nav, gain, earth, state.v_in_nav, dt));

  NavState next;
  next.v_in_nav = UpdateVelocity(state.v_in_nav, gain, earth, v_middle, dt);
  const Vector3d mean = 0.5 * (state.v_in_nav + next.v_in_nav);
  next.ecef_from_nav = UpdatePosition(state.ecef_from_nav, turn_of_nav(mean), dt);
  next.height_m = state.height_m + dt * mean.z();
  next.nav_from_body = UpdateAttitude(state.nav_from_body, turn_of_nav(mean), previous, now);
  return next;
}

}  // namespace survey
