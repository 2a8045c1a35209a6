// SPDX-License-Identifier: Apache-2.0
//
// What the adjustment of a block (`adjust`) found: every scan in the site frame (or in the block's local frame when the
// block is not tied to control), with covariances, the marks' residuals and the tests. [CN] eq. (8)-(11).
#pragma once

#include <Eigen/Core>
#include <optional>
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

// How well the others control a mark on a control point, and what they say about it [Baarda68].
struct MarkTest {
  double redundancy = 0.0;  // 0: nothing would show an error, 1: everything
  double t = 0.0;           // chi-square with `degrees_of_freedom` (2) when nothing is wrong
  int degrees_of_freedom = 2;
  std::optional<double> detectable;     // smallest error that the test finds (m); empty: none however large
  std::optional<double> largest_shift;  // of any pose by an error of that size that was not found (m)
  Eigen::Vector2d left_out = Eigen::Vector2d::Zero();  // place by the others minus given, when it is left out
  Eigen::Matrix2d left_out_covariance = Eigen::Matrix2d::Zero();  // of that; zero where it is not determined
};

struct SolvedSubmap {
  SubmapId id;
  Pose2 site_from_submap;
};

// One occupation after the adjustment. `used` marks stood on control points and took part; the others (check, tie, left
// out as blunders) are positions only.
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
  std::string left_out;          // why a mark on a control point took no part; empty when it did
  std::optional<MarkTest> test;  // of marks on control points, used or left out
};

// Tests of the control as a whole, in a surveyor's order: free, rigid, similarity, constrained.
struct ControlVerdict {
  double free_sigma_zero = 0.0;  // of the network without control
  double rigid_rms = 0.0;        // of the used marks after the rigid fit, m
  double scale_deviation = 0.0;  // of the similarity fit from 1, weighted; never applied
  double scale_sigma = 0.0;
  double chi_square = 0.0;  // of the misfit between control and free network
  int degrees_of_freedom = 0;
  double chi_square_lower = 0.0;  // 95 % bounds, two-sided
  double chi_square_upper = 0.0;
  double critical_t = 0.0;    // of one mark, at 0.001
  double rejection_t = 0.0;   // beyond it a mark is left out: 0.5 % for a whole block without blunders
  bool contradicted = false;  // nothing tells which points are wrong: none was left out
};

// Variance component of a kind of observations [Foerstner79]: squared, weighted residuals by redundancy; 1 where the
// sigmas are true. Of the track without what its two copies, memberships and motions, have between themselves.
struct VarianceComponent {
  std::string kind;  // "track", "loop", "answer", "control"
  int count = 0;
  double redundancy = 0.0;
  double factor = 0.0;
};

struct AdjustmentStatistics {
  int num_nodes = 0;
  int num_submaps = 0;
  int num_track_constraints = 0;
  int num_loops = 0;
  int num_control_marks = 0;
  int degrees_of_freedom = 0;  // without those between the two copies of the track
  int iterations = 0;
  double initial_cost = 0.0;  // half the sum of the squared, whitened residuals
  double final_cost = 0.0;
  double sigma_zero = 0.0;  // without the track's own cost
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
  ControlVerdict control;  // of tied blocks with two control points or more
  std::vector<VarianceComponent> components;
  std::vector<std::string> findings;  // sentences: blunders, a scale, control that does not fit
};

}  // namespace survey
