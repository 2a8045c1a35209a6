// SPDX-License-Identifier: Apache-2.0
//
// The front end: local SLAM of one block, [CN] section 2.1-2.2 with the submaps of [Hess16] section IV. Every scan is
// predicted from the one before, matched in the older of the two active submaps, and inserted into both when the
// platform has moved. Works in the block's local frame and never sees control.
#pragma once

#include <functional>

#include "survey/grid/occupancy_pyramid.h"
#include "survey/matching/gauss_newton.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

// Uncertainty of a predicted motion: sigma = base + per metre * path + per radian * turn (+ what the last innovations
// show).
struct MotionNoise {
  double sigma_m = 0.02;
  double sigma_m_per_m = 0.10;
  double sigma_rad = 0.01;
  double sigma_rad_per_rad = 0.15;
  double sigma_rad_per_m = 0.02;
  double acceleration_m_s2 = 0.5;  // of the constant-velocity model
  double acceleration_rad_s2 = 1.5;
};

struct TrackOptions {
  OccupancyOptions grid;
  MatchOptions match;
  MotionNoise motion;
  double max_range_m = 30.0;         // beams beyond are not used
  double point_spacing_m = 0.05;     // end points closer along the scan are thinned for matching
  int max_points = 250;              // for matching
  double insert_distance_m = 0.2;    // a scan is inserted (becomes a node) after this motion ...
  double insert_angle_rad = 0.09;    // ... or this turn
  int submap_nodes = 120;            // nodes in a submap; the next one starts at half
  int min_points = 20;               // fewer end points cannot be matched
  double search_half_width_m = 0.3;  // window when the match from the prediction is poor
  double search_half_angle_rad = 0.25;
  double poor_score_ratio = 0.75;  // poor: below this share of the recent scores
  double max_odometry_gap_s = 1.0;
};

// `progress` is called with the number of scans done.
Track TrackBlock(const Session& session, const TrackOptions& options,
                 const std::function<void(std::size_t)>& progress = {});

}  // namespace survey
