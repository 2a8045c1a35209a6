// SPDX-License-Identifier: Apache-2.0
//
// The row of the table `navigation`, which tracks and solutions share.
#pragma once

namespace formats {

inline constexpr auto kNavigationRow = [](auto& row, auto& id, auto& navigation) {
  row(id, navigation.inertial_s, navigation.odometry_s, navigation.constant_velocity_s, navigation.unmatched_s,
      navigation.imu_restarts, navigation.gyro_bias, navigation.accelerometer_bias);
};

}  // namespace formats
