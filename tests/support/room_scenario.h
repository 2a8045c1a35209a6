// SPDX-License-Identifier: Apache-2.0
//
// A small simulated world for tests: an empty room with one block that drives a loop over two points.
#pragma once

#include "survey/simulation/scenario.h"

namespace test_support {

// Interior 0 <= x <= 24, 0 <= y <= 16 (m).
inline survey::Scenario RoomScenario() {
  survey::Scenario scenario;
  scenario.name = "room";
  scenario.origin_in_site = {500000.0, 5600000.0};
  scenario.seed = 5;
  scenario.walls.push_back(
      {.line = {{-0.1, -0.1}, {24.1, -0.1}, {24.1, 16.1}, {-0.1, 16.1}}, .thickness_m = 0.2, .closed = true});
  scenario.points = {{.name = "A", .position = {12.0, 4.0}}, {.name = "B", .position = {18.0, 8.0}}};
  scenario.stop_s = 2.0;
  scenario.blocks.push_back({.name = "B1",
                             .start_s = 100.0,
                             .waypoints = {{{4.0, 4.0}, ""},
                                           {{12.0, 4.0}, "A"},
                                           {{18.0, 4.0}, ""},
                                           {{18.0, 8.0}, "B"},
                                           {{18.0, 12.0}, ""},
                                           {{4.0, 12.0}, ""},
                                           {{4.0, 5.0}, ""}}});
  return scenario;
}

// The same with sensors that make no error and a level floor.
inline survey::Scenario PerfectRoomScenario() {
  survey::Scenario scenario = RoomScenario();
  scenario.lidar.near_sigma_m = 0.0;
  scenario.lidar.far_sigma_m = 0.0;
  scenario.lidar.dropout_probability = 0.0;
  scenario.imu.gyro_bias_sigma_rad_s = 0.0;
  scenario.imu.gyro_noise_rad_s_rthz = 0.0;
  scenario.imu.accelerometer_bias_sigma_m_s2 = 0.0;
  scenario.imu.accelerometer_noise_m_s2_rthz = 0.0;
  scenario.odometry = {.scale_error = 0.0,
                       .angular_drift_rad_per_m = 0.0,
                       .angular_scale_error = 0.0,
                       .distance_noise_m_rtm = 0.0,
                       .angular_noise_rad_rtrad = 0.0,
                       .slips_per_m = 0.0};
  scenario.centring_sigma_m = 0.0;
  scenario.cart.floor_tilt_rad = 0.0;
  return scenario;
}

}  // namespace test_support
