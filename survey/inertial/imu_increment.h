// SPDX-License-Identifier: Apache-2.0
//
// What an inertial unit adds up over one interval, in its body frame at the interval's end: the currency of the
// mechanization. Units that deliver rates are integrated by the trapezoid.
#pragma once

#include <Eigen/Core>

#include "survey/sensors/session.h"

namespace survey {

struct ImuIncrement {
  double dt_s = 0.0;
  Eigen::Vector3d dtheta = Eigen::Vector3d::Zero();  // integral of the angular rate, rad
  Eigen::Vector3d dvel = Eigen::Vector3d::Zero();    // integral of the specific force, m/s
};

inline ImuIncrement IncrementBetween(const ImuSample& from, const ImuSample& to) {
  const double dt = Seconds(to.stamp_ns - from.stamp_ns);
  return {dt, 0.5 * dt * (from.angular_rate_in_body + to.angular_rate_in_body),
          0.5 * dt * (from.specific_force_in_body + to.specific_force_in_body)};
}

// Without the errors of the instruments (rad/s, m/s2).
inline ImuIncrement Corrected(const ImuIncrement& raw, const Eigen::Vector3d& gyro_bias,
                              const Eigen::Vector3d& accelerometer_bias) {
  return {raw.dt_s, raw.dtheta - raw.dt_s * gyro_bias, raw.dvel - raw.dt_s * accelerometer_bias};
}

}  // namespace survey
