// SPDX-License-Identifier: Apache-2.0
//
// Motions over the Earth whose rates and specific forces are exact, and the increments that a faultless inertial unit
// would deliver on them. Frames as in survey/inertial/strapdown.h (east, north, up; forward, left, up).
#pragma once

#include <functional>
#include <vector>

#include "survey/inertial/strapdown.h"

namespace test_support {

// The motion at one time: velocity and its derivative in nav, attitude, rate of the body against nav in the body.
struct Motion {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d dv = Eigen::Vector3d::Zero();
  Eigen::Quaterniond nav_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_in_body = Eigen::Vector3d::Zero();
};
using MotionOfTime = std::function<Motion(double time_s)>;

struct Place {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
  double height_m = 0.0;
};

// Where the velocity leads from a place: steps of at most step_s, fourth order.
Place Travel(const MotionOfTime& motion, Place place, double from_s, double to_s, double step_s);

// Integrals over [from, to] of rate and specific force by Gauss' rule in pieces of at most step_s, at the places that
// the motion leads through from `place`.
survey::ImuIncrement ExactIncrement(const MotionOfTime& motion, const Place& place, double from_s, double to_s,
                                    double step_s);

struct DeadReckoning {
  survey::NavState state;
  Place place;    // that the motion leads to
  Motion motion;  // at the end
};
// Mechanizes exact increments of dt_s from `from` to `to`, starting on the truth.
DeadReckoning Reckon(const MotionOfTime& motion, const Place& start, double from_s, double to_s, double dt_s);

struct NavigationError {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double attitude_rad = 0.0;
};
NavigationError ErrorOf(const DeadReckoning& reckoned);

// Attitude exp(phi) with phi(t) and its derivative, and the rate of the body in the body.
void SetAttitude(const Eigen::Vector3d& phi, const Eigen::Vector3d& dphi, Motion* motion);

}  // namespace test_support
