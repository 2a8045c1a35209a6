// SPDX-License-Identifier: Apache-2.0
//
// Strapdown mechanization in the navigation frame, [CN] eq. (2)-(5): velocity with Coriolis, transport rate and
// gravity; position by quaternion; attitude by rotation vector, with coning and sculling of second order from two
// increments, the rates taken as linear over both ([Savage98], parts 1 and 2).
//
// Frames: `nav` is east, north, up; `body` is x forward, y left, z up; `ecef` as in WGS 84. The paper prints
// cos(|0.5 z|/|z|) and sin(|0.5 z|/|z|)/|z| in eq. (4)-(5); meant are cos|0.5 z| and sin|0.5 z|/|z|, the quaternion of
// the rotation vector z. Its z is the turn of nav in inertial space, (w_ie + w_en) dt, its xi the turn of the Earth.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/inertial/earth.h"
#include "survey/inertial/imu_increment.h"

namespace survey {

struct NavState {
  Eigen::Quaterniond ecef_from_nav = Eigen::Quaterniond::Identity();  // the place on the ellipsoid
  double height_m = 0.0;
  Eigen::Vector3d v_in_nav = Eigen::Vector3d::Zero();  // over the Earth, m/s
  Eigen::Quaterniond nav_from_body = Eigen::Quaterniond::Identity();
};

struct GeodeticPlace {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
};
Eigen::Quaterniond EcefFromNav(const GeodeticPlace& place);
GeodeticPlace PlaceOf(const Eigen::Quaterniond& ecef_from_nav);

// Quaternion of a rotation vector (rad), of any length.
Eigen::Quaterniond FromRotationVector(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d ToRotationVector(const Eigen::Quaterniond& rotation);

// The three updates over one increment. `previous` is the increment before (zero at the start: coning and sculling are
// then of first order for one step); `turn_of_nav` the rotation vector (w_ie + w_en) dt of the navigation frame.

// Velocity gained by the specific force, in the navigation frame half way through the interval, m/s.
Eigen::Vector3d VelocityGain(const Eigen::Quaterniond& nav_from_body, const Eigen::Vector3d& turn_of_nav,
                             const ImuIncrement& previous, const ImuIncrement& now);
// Eq. (2), `earth` and `v_middle` taken half way through the interval.
Eigen::Vector3d UpdateVelocity(const Eigen::Vector3d& v_in_nav, const Eigen::Vector3d& gain, const Earth& earth,
                               const Eigen::Vector3d& v_middle, double dt_s);
// Eq. (3)-(5).
Eigen::Quaterniond UpdatePosition(const Eigen::Quaterniond& ecef_from_nav, const Eigen::Vector3d& turn_of_nav,
                                  double dt_s);
Eigen::Quaterniond UpdateAttitude(const Eigen::Quaterniond& nav_from_body, const Eigen::Vector3d& turn_of_nav,
                                  const ImuIncrement& previous, const ImuIncrement& now);

// All three, in this order.
NavState Mechanize(const NavState& state, const ImuIncrement& previous, const ImuIncrement& now);

}  // namespace survey
