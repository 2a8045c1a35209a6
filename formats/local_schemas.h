// SPDX-License-Identifier: Apache-2.0
//
// Schemas of what a block is in its own frame: its field data, its track, its loops. None of them sees control.
#pragma once

#include <string_view>

namespace formats {

inline constexpr std::string_view kSessionSchema = R"(
CREATE TABLE setup (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  lidar_x REAL NOT NULL,      -- body_from_lidar: m
  lidar_y REAL NOT NULL,      -- m
  lidar_theta REAL NOT NULL,  -- rad, counter-clockwise
  mark_x REAL NOT NULL,       -- the marked place in the lidar frame (lever arm): m
  mark_y REAL NOT NULL,       -- m
  range_sigma REAL NOT NULL CHECK (range_sigma >= 0),  -- m, 1 sigma
  mark_sigma REAL NOT NULL CHECK (mark_sigma >= 0)     -- m, 1 sigma per axis
) STRICT;
CREATE TABLE geometries (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  angle_min REAL NOT NULL,        -- rad, lidar frame
  angle_increment REAL NOT NULL,  -- rad
  time_increment REAL NOT NULL,   -- s
  range_min REAL NOT NULL,        -- m
  range_max REAL NOT NULL,        -- m
  num_beams INTEGER NOT NULL CHECK (num_beams > 0)
) STRICT;
CREATE TABLE scans (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  stamp_ns INTEGER NOT NULL,  -- of the first beam
  geometry INTEGER NOT NULL REFERENCES geometries (id),
  ranges BLOB NOT NULL,       -- float32 little-endian, m; +inf: no return; NaN: invalid
  ranges_crc32 INTEGER NOT NULL,
  clock_repair_ns INTEGER NOT NULL  -- stamp_ns minus the stamp that the raw log prints
) STRICT;
CREATE TABLE imu (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  stamp_ns INTEGER NOT NULL,
  gyro_x REAL NOT NULL,   -- angular rate in the body frame, rad/s
  gyro_y REAL NOT NULL,
  gyro_z REAL NOT NULL,
  accel_x REAL NOT NULL,  -- specific force in the body frame, m/s2
  accel_y REAL NOT NULL,
  accel_z REAL NOT NULL
) STRICT;
CREATE TABLE odometry (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  stamp_ns INTEGER NOT NULL,
  x REAL NOT NULL,     -- odom_from_body: m
  y REAL NOT NULL,     -- m
  theta REAL NOT NULL  -- rad
) STRICT;
CREATE TABLE marks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  point TEXT NOT NULL CHECK (point <> ''),
  start_ns INTEGER NOT NULL,
  end_ns INTEGER NOT NULL CHECK (end_ns >= start_ns)
) STRICT;
)";

inline constexpr std::string_view kTrackSchema = R"(
CREATE TABLE scans (
  scan INTEGER PRIMARY KEY CHECK (scan >= 0),  -- index in the session
  stamp_ns INTEGER NOT NULL,           -- on the block's clock
  recorded_stamp_ns INTEGER NOT NULL,  -- as the raw log prints it
  x REAL NOT NULL,      -- local_from_scan: m
  y REAL NOT NULL,      -- m
  theta REAL NOT NULL,  -- rad
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- of the match in the submap: m2, m rad, rad2
  cov_xy REAL NOT NULL,
  cov_xt REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  cov_yt REAL NOT NULL,
  cov_tt REAL NOT NULL CHECK (cov_tt >= 0),
  prediction TEXT NOT NULL CHECK (prediction IN ('start', 'odometry', 'inertial', 'constant velocity')),
  matched INTEGER NOT NULL CHECK (matched IN (0, 1)),
  is_node INTEGER NOT NULL CHECK (is_node IN (0, 1)),
  score REAL NOT NULL   -- mean occupancy probability at the end points
) STRICT;
CREATE TABLE submaps (
  submap INTEGER PRIMARY KEY CHECK (submap >= 0),
  x REAL NOT NULL,     -- local_from_submap: m
  y REAL NOT NULL,     -- m
  theta REAL NOT NULL  -- rad
) STRICT;
CREATE TABLE submap_nodes (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  submap INTEGER NOT NULL REFERENCES submaps (submap),
  scan INTEGER NOT NULL REFERENCES scans (scan)
) STRICT;
CREATE TABLE constraints (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  submap INTEGER NOT NULL REFERENCES submaps (submap),
  scan INTEGER NOT NULL REFERENCES scans (scan),
  x REAL NOT NULL,      -- submap_from_scan: m
  y REAL NOT NULL,      -- m
  theta REAL NOT NULL,  -- rad
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- in the submap frame: m2, m rad, rad2
  cov_xy REAL NOT NULL,
  cov_xt REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  cov_yt REAL NOT NULL,
  cov_tt REAL NOT NULL CHECK (cov_tt >= 0)
) STRICT;
CREATE TABLE marks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  point TEXT NOT NULL CHECK (point <> ''),
  start_ns INTEGER NOT NULL,
  end_ns INTEGER NOT NULL CHECK (end_ns >= start_ns),
  scan INTEGER NOT NULL REFERENCES scans (scan),  -- the node that carries the mark
  mark_x REAL NOT NULL,  -- the marked place in the frame of that scan: m
  mark_y REAL NOT NULL,  -- m
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- m2
  cov_xy REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0)
) STRICT;
CREATE TABLE requests (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  scan INTEGER NOT NULL REFERENCES scans (scan),
  cause TEXT NOT NULL,
  doubt REAL NOT NULL,  -- larger is worse
  message TEXT NOT NULL
) STRICT;
CREATE TABLE request_modes (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  request INTEGER NOT NULL REFERENCES requests (id),
  x REAL NOT NULL,      -- local_from_scan that the request's scan may have: m
  y REAL NOT NULL,      -- m
  theta REAL NOT NULL,  -- rad
  weight REAL NOT NULL CHECK (weight >= 0 AND weight <= 1.000001)
) STRICT;
CREATE TABLE navigation (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  inertial REAL NOT NULL CHECK (inertial >= 0),  -- s by the IMU, with or without odometry beside it
  odometry REAL NOT NULL CHECK (odometry >= 0),  -- s by odometry without IMU
  constant_velocity REAL NOT NULL CHECK (constant_velocity >= 0),  -- s by neither
  unmatched REAL NOT NULL CHECK (unmatched >= 0),  -- s of all these without a scan match
  imu_restarts INTEGER NOT NULL CHECK (imu_restarts >= 0),  -- behind gaps
  gyro_bias_x REAL NOT NULL,  -- mean over the block, rad/s
  gyro_bias_y REAL NOT NULL,
  gyro_bias_z REAL NOT NULL,
  accel_bias_x REAL NOT NULL,  -- m/s2
  accel_bias_y REAL NOT NULL,
  accel_bias_z REAL NOT NULL
) STRICT;
)";

inline constexpr std::string_view kLoopsSchema = R"(
CREATE TABLE search (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  candidates_searched INTEGER NOT NULL CHECK (candidates_searched >= 0)
) STRICT;
CREATE TABLE loops (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  submap INTEGER NOT NULL CHECK (submap >= 0),  -- as in the track
  scan INTEGER NOT NULL CHECK (scan >= 0),
  x REAL NOT NULL,      -- submap_from_scan: m
  y REAL NOT NULL,      -- m
  theta REAL NOT NULL,  -- rad
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- in the submap frame: m2, m rad, rad2
  cov_xy REAL NOT NULL,
  cov_xt REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  cov_yt REAL NOT NULL,
  cov_tt REAL NOT NULL CHECK (cov_tt >= 0),
  score REAL NOT NULL,
  accepted INTEGER NOT NULL CHECK (accepted IN (0, 1)),
  reason TEXT NOT NULL  -- why not accepted
) STRICT;
)";

}  // namespace formats
