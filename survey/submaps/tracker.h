// SPDX-License-Identifier: Apache-2.0
//
// The front end: local SLAM of one block, [CN] section 2.1-2.2 with the submaps of [Hess16] section IV. Every scan is
// predicted from the one before, matched in the older of the two active submaps, and inserted into both when the
// platform has moved. Works in the block's local frame and never sees control.
#pragma once

#include <functional>

#include "survey/sensors/session.h"
#include "survey/submaps/motion_predictor.h"
#include "survey/submaps/track.h"
#include "survey/submaps/tracking_map.h"

namespace survey {

struct TrackOptions {
  TrackingMapOptions map;
  MotionNoise motion;
  InertialOptions inertial;
  double max_range_m = 30.0;           // beams beyond are not used
  double insert_distance_m = 0.2;      // a scan is inserted (becomes a node) after this motion ...
  double insert_angle_rad = 0.09;      // ... or this turn
  int submap_nodes = 120;              // nodes in a submap; the next one starts at half
  int min_points = 20;                 // fewer end points cannot be matched
  double doubtful_score_ratio = 0.75;  // of the recent scores: below, the prediction's surroundings are searched ...
  double poor_score_ratio = 0.6;       // ... and below this the whole window, or as far as a gap of the scans asks for
  double search_half_width_m = 1.0;
  double search_half_angle_rad = 0.6;  // twice that far in the end
  double min_score_gain = 0.1;         // what a pose far from the prediction must have over the one near to it
};

// `progress` is called with the number of scans done.
Track TrackBlock(const Session& session, const TrackOptions& options,
                 const std::function<void(std::size_t)>& progress = {});

}  // namespace survey
