// SPDX-License-Identifier: Apache-2.0
//
// The lines of a CARMEN log as they stand; carmen_log.h makes field data of them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace formats {

// FLASER, RLASER: ranges and poses. RAWLASER: ranges and geometry. ROBOTLASER: all of them.
struct CarmenLaser {
  int row = 0;
  survey::StampNs stamp_ns = 0;   // ipc_timestamp
  survey::StampNs logger_ns = 0;  // logger_timestamp, from the start of the logging program
  bool states_geometry = false;
  bool is_sick_lms = true;  // FLASER and RLASER do not say, but come from the time when it was the only one
  double start_angle_rad = 0.0;
  double resolution_rad = 0.0;
  double range_max_m = 0.0;
  std::vector<float> ranges_m;  // as printed
  std::optional<survey::Pose2> odom_from_lidar;
  std::optional<survey::Pose2> odom_from_body;
};

struct CarmenOdometry {
  int row = 0;
  survey::StampNs stamp_ns = 0;   // ipc_timestamp
  survey::StampNs logger_ns = 0;  // logger_timestamp
  survey::Pose2 odom_from_body;
};

struct CarmenMessages {
  std::map<std::string, std::vector<CarmenLaser>> lasers;  // by message name
  std::vector<CarmenOdometry> odometry;
  std::map<std::string, double> laser_params;  // numeric PARAM robot_frontlaser_*, robot_rearlaser_*
  std::string cut_off;                         // what the last line was when the file ends within it; else empty
};

// DataError names file, row, field and rule.
CarmenMessages ReadCarmenMessages(const std::filesystem::path& file);

}  // namespace formats
