// SPDX-License-Identifier: Apache-2.0
//
// What the adjustment of a block (`adjust`) found: every scan in the site frame (or in the block's local frame when the
// block is not tied to control), with covariances, the marks' residuals and the tests. [CN] eq. (8)-(11).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/geometry/pose2.h"
#include "survey/submaps/track.h"

namespace survey {

struct SolvedScan {
  ScanId scan;
  Pose2 site_from_scan;
  bool is_node = false;
};

// Covariance of a node's pose in the site frame: x, y (m), theta (rad).
struct NodeCovariance {
  ScanId scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

struct SolvedSubmap {
  SubmapId id;
  Pose2 site_from_submap;
};

// One occupation after the adjustment. `used` marks stood on control points and took part; the others (check, tie) are
// positions only.
struct SolvedMark {
  std::string point;
  StampNs start_ns = 0;
  StampNs end_ns = 0;
  ScanId scan;  // the node that carries the mark
  bool used = false;
  Eigen::Vector2d position_in_site = Eigen::Vector2d::Zero();  // where the adjusted trajectory puts the mark
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();        // of that position
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();          // position - given coordinates, control marks only
  Eigen::Vector2d rigid_residual = Eigen::Vector2d::Zero();    // the same before the adjustment, after a rigid fit
};

struct AdjustmentStatistics {
  int num_nodes = 0;
  int num_submaps = 0;
  int num_track_constraints = 0;
  int num_loops = 0;
  int num_control_marks = 0;
  int degrees_of_freedom = 0;
  int iterations = 0;
  double initial_cost = 0.0;  // half the sum of the squared, whitened residuals
  double final_cost = 0.0;
  double sigma_zero = 0.0;  // sqrt(2 final_cost / degrees_of_freedom)
};

struct Solution {
  bool tied = false;  // tied to control; otherwise "site" below is the block's local frame
  SiteFrame frame;
  Pose2 site_from_local;          // the rigid fit on the marks; identity when not tied
  double rigid_scale = 1.0;       // scale that a four-parameter fit would have taken (never applied)
  std::vector<SolvedScan> scans;  // all scans of the session, in its order
  std::vector<NodeCovariance> covariances;
  std::vector<SolvedSubmap> submaps;
  std::vector<SolvedMark> marks;
  NavigationSummary navigation;  // of the track
  std::vector<TrackBreak> breaks;
  AdjustmentStatistics statistics;
};

}  // namespace survey
