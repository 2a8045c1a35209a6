// SPDX-License-Identifier: Apache-2.0
//
// Schemas of what stands in the site's frame: control, adjusted poses and the observations behind them, features.
#pragma once

#include <string_view>

namespace formats {

inline constexpr std::string_view kControlSchema = R"(
CREATE TABLE frame (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  crs TEXT NOT NULL,  -- 'EPSG:25832'; empty: the control's own plane
  wkt2 TEXT NOT NULL
) STRICT;
CREATE TABLE points (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  name TEXT NOT NULL UNIQUE CHECK (name <> ''),
  role TEXT NOT NULL CHECK (role IN ('control', 'check', 'tie', 'excluded')),
  easting REAL NOT NULL,   -- site frame, m
  northing REAL NOT NULL,  -- m
  cov_ee REAL NOT NULL CHECK (cov_ee >= 0),  -- m2
  cov_en REAL NOT NULL,
  cov_nn REAL NOT NULL CHECK (cov_nn >= 0),
  elevation REAL,          -- m; NULL: not given
  elevation_sigma REAL CHECK (elevation_sigma >= 0),  -- m, 1 sigma; NULL: not given
  description TEXT NOT NULL,
  reason TEXT NOT NULL     -- why excluded
) STRICT;
CREATE TABLE correlations (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  point_a INTEGER NOT NULL REFERENCES points (id),
  point_b INTEGER NOT NULL REFERENCES points (id),
  cov_ee REAL NOT NULL,  -- of a's easting with b's easting, m2
  cov_en REAL NOT NULL,  -- of a's easting with b's northing
  cov_ne REAL NOT NULL,
  cov_nn REAL NOT NULL,
  CHECK (point_a < point_b),
  UNIQUE (point_a, point_b)
) STRICT;
CREATE TABLE adjustment (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  software TEXT NOT NULL,
  description TEXT NOT NULL,
  num_observations INTEGER NOT NULL CHECK (num_observations >= 0),
  num_unknowns INTEGER NOT NULL CHECK (num_unknowns >= 0),
  defect INTEGER NOT NULL CHECK (defect >= 0),  -- settled by constrained coordinates
  degrees_of_freedom INTEGER NOT NULL CHECK (degrees_of_freedom >= 0),
  sigma_zero_a_priori REAL NOT NULL CHECK (sigma_zero_a_priori > 0),
  sigma_zero REAL NOT NULL CHECK (sigma_zero >= 0),  -- a posteriori; 0 without redundancy
  degrees INTEGER NOT NULL CHECK (degrees IN (0, 1)),  -- angles were given in degrees, else gon
  scaled INTEGER NOT NULL CHECK (scaled IN (0, 1)),    -- covariances are scaled by sigma zero a posteriori
  confidence REAL NOT NULL CHECK (confidence > 0 AND confidence < 1),
  chi_square REAL NOT NULL,
  chi_square_lower REAL NOT NULL,
  chi_square_upper REAL NOT NULL,
  critical_w REAL NOT NULL CHECK (critical_w >= 0),  -- 0: single observations were not tested here
  largest_w REAL NOT NULL CHECK (largest_w >= 0),
  num_uncontrolled INTEGER NOT NULL CHECK (num_uncontrolled >= 0),
  num_suspected INTEGER NOT NULL CHECK (num_suspected >= 0)
) STRICT;
CREATE TABLE observations (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  kind TEXT NOT NULL,
  from_point TEXT NOT NULL,
  to_point TEXT NOT NULL,    -- of an angle: the backsight
  fore_point TEXT NOT NULL,  -- of an angle: the foresight
  angular INTEGER NOT NULL CHECK (angular IN (0, 1)),  -- values in rad, else m
  observed REAL NOT NULL,    -- horizontal angles clockwise
  sigma REAL NOT NULL CHECK (sigma > 0),  -- a priori
  adjusted REAL NOT NULL,
  residual REAL NOT NULL,    -- adjusted minus observed
  sigma_adjusted REAL NOT NULL CHECK (sigma_adjusted >= 0),  -- a priori
  w REAL NOT NULL,           -- test statistic; 0 where nothing controls the observation
  redundancy REAL NOT NULL CHECK (redundancy >= 0 AND redundancy <= 1),
  minimal_detectable_bias REAL,  -- NULL: nothing controls it
  suspected INTEGER NOT NULL CHECK (suspected >= 0)  -- as the n-th outlier; 0: not
) STRICT;
CREATE TABLE remarks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  remark TEXT NOT NULL  -- how the coordinates came into the site's system
) STRICT;
)";

inline constexpr std::string_view kSolutionSchema = R"(
CREATE TABLE block (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  tied INTEGER NOT NULL CHECK (tied IN (0, 1)),  -- 0: not tied to control, the site frame is the local frame
  crs TEXT NOT NULL,
  wkt2 TEXT NOT NULL,
  x REAL NOT NULL,           -- site_from_local by a rigid fit on the marks: m
  y REAL NOT NULL,           -- m
  theta REAL NOT NULL,       -- rad
  rigid_scale REAL NOT NULL  -- of a four-parameter fit; never applied
) STRICT;
CREATE TABLE scans (
  scan INTEGER PRIMARY KEY CHECK (scan >= 0),  -- index in the session
  stamp_ns INTEGER NOT NULL,           -- on the block's clock
  recorded_stamp_ns INTEGER NOT NULL,  -- as the raw log prints it
  x REAL NOT NULL,      -- site_from_scan: easting, m
  y REAL NOT NULL,      -- northing, m
  theta REAL NOT NULL,  -- rad, from east towards north
  is_node INTEGER NOT NULL CHECK (is_node IN (0, 1))
) STRICT;
CREATE TABLE node_covariances (
  scan INTEGER PRIMARY KEY REFERENCES scans (scan),
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- in the site frame: m2, m rad, rad2
  cov_xy REAL NOT NULL,
  cov_xt REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  cov_yt REAL NOT NULL,
  cov_tt REAL NOT NULL CHECK (cov_tt >= 0)
) STRICT;
CREATE TABLE submaps (
  submap INTEGER PRIMARY KEY CHECK (submap >= 0),
  x REAL NOT NULL,     -- site_from_submap: m
  y REAL NOT NULL,     -- m
  theta REAL NOT NULL  -- rad
) STRICT;
CREATE TABLE marks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  point TEXT NOT NULL CHECK (point <> ''),
  start_ns INTEGER NOT NULL,
  end_ns INTEGER NOT NULL CHECK (end_ns >= start_ns),
  scan INTEGER NOT NULL REFERENCES scans (scan),      -- the node that carries the mark
  used INTEGER NOT NULL CHECK (used IN (0, 1)),       -- took part as control
  x REAL NOT NULL,                                    -- adjusted place of the mark, site frame: m
  y REAL NOT NULL,                                    -- m
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),           -- m2
  cov_xy REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  residual_x REAL NOT NULL,                           -- adjusted minus given, m; 0 where not on control
  residual_y REAL NOT NULL,
  rigid_residual_x REAL NOT NULL,                     -- the same after the rigid fit alone, m
  rigid_residual_y REAL NOT NULL,
  left_out TEXT NOT NULL                              -- why a mark on control took no part; empty: it did
) STRICT;
CREATE TABLE mark_tests (
  mark INTEGER PRIMARY KEY REFERENCES marks (id),  -- on a control point, used or left out
  redundancy REAL NOT NULL,  -- 0: nothing would show an error, 1: everything
  t REAL NOT NULL CHECK (t >= 0),  -- chi-square when nothing is wrong
  degrees_of_freedom INTEGER NOT NULL CHECK (degrees_of_freedom BETWEEN 0 AND 2),
  detectable REAL,     -- smallest error that the test finds: m; NULL: none however large
  largest_shift REAL,  -- of any pose by an error of that size: m
  left_out_x REAL NOT NULL,  -- place by the others minus given, m; 0 where it is not determined
  left_out_y REAL NOT NULL,
  left_out_cov_xx REAL NOT NULL CHECK (left_out_cov_xx >= 0),  -- m2
  left_out_cov_xy REAL NOT NULL,
  left_out_cov_yy REAL NOT NULL CHECK (left_out_cov_yy >= 0)
) STRICT;
CREATE TABLE control_verdict (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  free_sigma_zero REAL NOT NULL,  -- without control
  rigid_rms REAL NOT NULL,        -- of the used marks after the rigid fit: m
  scale_deviation REAL NOT NULL,  -- of the weighted similarity fit from 1; never applied
  scale_sigma REAL NOT NULL,
  chi_square REAL NOT NULL,       -- of the misfit between control and free network
  degrees_of_freedom INTEGER NOT NULL,
  chi_square_lower REAL NOT NULL,  -- 95 % bounds
  chi_square_upper REAL NOT NULL,
  critical_t REAL NOT NULL,       -- of one mark, at 0.001
  rejection_t REAL NOT NULL,      -- beyond it a mark is left out
  contradicted INTEGER NOT NULL CHECK (contradicted IN (0, 1))  -- too many would have to go: none was left out
) STRICT;
CREATE TABLE variance_components (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  kind TEXT NOT NULL,
  count INTEGER NOT NULL,
  redundancy REAL NOT NULL,
  factor REAL NOT NULL  -- of the a-priori variances, as the residuals have it
) STRICT;
CREATE TABLE findings (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  message TEXT NOT NULL
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
CREATE TABLE breaks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  scan INTEGER NOT NULL REFERENCES scans (scan),  -- the first one behind the break
  message TEXT NOT NULL
) STRICT;
CREATE TABLE statistics (
  id INTEGER PRIMARY KEY CHECK (id = 0),
  num_nodes INTEGER NOT NULL,
  num_submaps INTEGER NOT NULL,
  num_track_constraints INTEGER NOT NULL,
  num_loops INTEGER NOT NULL,
  num_control_marks INTEGER NOT NULL,
  degrees_of_freedom INTEGER NOT NULL,
  iterations INTEGER NOT NULL,
  initial_cost REAL NOT NULL,  -- half the sum of the squared, whitened residuals
  final_cost REAL NOT NULL,
  sigma_zero REAL              -- NULL: no degrees of freedom
) STRICT;
)";

inline constexpr std::string_view kFeaturesSchema = R"(
CREATE TABLE features (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  name TEXT NOT NULL UNIQUE CHECK (name <> ''),
  kind TEXT NOT NULL CHECK (kind IN ('corner', 'pillar')),
  found INTEGER NOT NULL CHECK (found IN (0, 1)),
  reason TEXT NOT NULL,   -- why not found
  x REAL NOT NULL,        -- in the map: easting, m; 0 where not found
  y REAL NOT NULL,        -- northing, m
  reading_xx REAL NOT NULL CHECK (reading_xx >= 0),  -- of the reading, as if the poses had no errors: m2
  reading_xy REAL NOT NULL,
  reading_yy REAL NOT NULL CHECK (reading_yy >= 0),
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- of the place in the site, by reading and poses: m2
  cov_xy REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  num_cells INTEGER NOT NULL CHECK (num_cells >= 0),  -- wall cells that took part
  CHECK ((found = 1) = (reason = ''))
) STRICT;
)";

inline constexpr std::string_view kGraphSchema = R"(
CREATE TABLE poses (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  scan INTEGER NOT NULL CHECK (scan >= -2),  -- -1: the submap of that id; -2, last: the site frame itself
  x REAL NOT NULL,      -- in the site frame: easting, m
  y REAL NOT NULL,      -- northing, m
  theta REAL NOT NULL   -- rad, from east towards north
) STRICT;
CREATE TABLE points (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  name TEXT NOT NULL,        -- in order of their names; then, without a name, places of marks that were left out
  control INTEGER NOT NULL CHECK (control IN (0, 1)),  -- its given coordinates took part
  x REAL NOT NULL,           -- adjusted: easting, m
  y REAL NOT NULL,           -- northing, m
  given_x REAL,              -- what a person gave for a point of the block's own: m; NULL: nothing
  given_y REAL,
  given_sigma REAL CHECK (given_sigma > 0),  -- per axis, m
  CHECK ((given_x IS NULL) = (given_sigma IS NULL) AND (given_y IS NULL) = (given_sigma IS NULL)),
  CHECK (control = 0 OR given_sigma IS NULL)
) STRICT;
CREATE TABLE marks (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  pose INTEGER NOT NULL REFERENCES poses (id),
  point INTEGER NOT NULL REFERENCES points (id),
  x REAL NOT NULL,  -- the point in the frame of the pose: m
  y REAL NOT NULL,  -- m
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- m2
  cov_xy REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0)
) STRICT;
CREATE TABLE edges (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  kind TEXT NOT NULL,  -- of the observation
  base INTEGER NOT NULL REFERENCES poses (id),
  target INTEGER NOT NULL REFERENCES poses (id),
  x REAL NOT NULL,      -- base_from_target as observed: m
  y REAL NOT NULL,      -- m
  theta REAL NOT NULL,  -- rad
  cov_xx REAL NOT NULL CHECK (cov_xx >= 0),  -- as it counted in the end, in the frame of base: m2, m rad, rad2
  cov_xy REAL NOT NULL,
  cov_xt REAL NOT NULL,
  cov_yy REAL NOT NULL CHECK (cov_yy >= 0),
  cov_yt REAL NOT NULL,
  cov_tt REAL NOT NULL CHECK (cov_tt >= 0)
) STRICT;
CREATE TABLE walls (
  id INTEGER PRIMARY KEY CHECK (id >= 0),
  relation TEXT NOT NULL CHECK (relation IN ('collinear', 'parallel', 'perpendicular')),
  base INTEGER NOT NULL REFERENCES poses (id),
  target INTEGER NOT NULL REFERENCES poses (id),
  base_ax REAL NOT NULL,    -- ends of the wall in the frame of base: m
  base_ay REAL NOT NULL,    -- m
  base_bx REAL NOT NULL,    -- m
  base_by REAL NOT NULL,    -- m
  target_ax REAL NOT NULL,  -- in the frame of target
  target_ay REAL NOT NULL,  -- m
  target_bx REAL NOT NULL,  -- m
  target_by REAL NOT NULL,  -- m
  sigma_m REAL NOT NULL CHECK (sigma_m > 0),
  sigma_rad REAL NOT NULL CHECK (sigma_rad > 0)
) STRICT;
)";

}  // namespace formats
