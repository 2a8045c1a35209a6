// SPDX-License-Identifier: Apache-2.0
//
// What the certificate of a site says. Lengths in metres, site frame (east, north). Four levels of evidence are kept
// apart: "tested" (check points and check features that the adjustment never saw), "cross-validated" (control against
// all other control), "relative" and "stitching" (the map's inner agreement, [CN] tables 1 and 3), "fit" (control that
// was used: says nothing about accuracy).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "survey/accuracy/check_analysis.h"
#include "survey/accuracy/control_reliability.h"
#include "survey/accuracy/cross_validation.h"
#include "survey/accuracy/delivery.h"
#include "survey/accuracy/edit_summary.h"
#include "survey/accuracy/error_statistics.h"
#include "survey/control/control_point.h"
#include "survey/graph/joint_summary.h"

namespace survey {

// One mark on a control point that took part in the adjustment.
struct FitResidual {
  std::string block;
  std::string point;
  Eigen::Vector2d given = Eigen::Vector2d::Zero();           // coordinates of the control point
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();        // adjusted mark - given
  Eigen::Vector2d rigid_residual = Eigen::Vector2d::Zero();  // before the adjustment, after a rigid fit
};

enum class CheckKind { kPoint, kFeature };  // a mark of the platform on a check point; a feature measured in the map

struct TestedCheck {
  CheckKind kind = CheckKind::kPoint;
  std::string block;
  std::string name;
  Eigen::Vector2d in_map = Eigen::Vector2d::Zero();
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();
  Eigen::Vector2d error = Eigen::Vector2d::Zero();                 // in_map - reference
  Eigen::Matrix2d reference_covariance = Eigen::Matrix2d::Zero();  // survey and picking, m2
  std::optional<double> distance_to_control;                       // to the nearest used control point of the site
  bool blunder = false;                                            // beyond the class's blunder limit; never dropped
  bool outlier = false;                                            // does not belong to the others; never dropped
};

// Errors of one kind of check over one block or the site.
struct AccuracyTest {
  ErrorStatistics statistics;
  std::optional<ClassVerdict> verdict;  // with a class and at least one check
};

// Common features after a rigid fit: the map's own shape, wherever it lies.
struct RelativeAccuracy {
  int num_features = 0;
  double rms = 0.0;    // of the lengths of the residuals
  double scale = 1.0;  // a four-parameter fit's; not applied
};

// By what the block was navigated, s; see NavigationSummary.
struct NavigatedTimes {
  double inertial = 0.0;
  double odometry = 0.0;
  double constant_velocity = 0.0;
  double unmatched = 0.0;
};

// What a person was asked about a block. Requests without an answer are assumed to be right.
struct BlockReview {
  int num_requests = 0;
  int num_answered = 0;
  int num_skipped = 0;  // seen, not decided
  int num_open = 0;
  int num_answers = 0;         // all of the block, also those whose request has gone
  int cells_compared = 0;      // wall cells of one pass that another pass saw or saw through
  int cells_contradicted = 0;  // of these: seen through
  double ContradictedShare() const {
    return cells_compared > 0 ? static_cast<double>(cells_contradicted) / cells_compared : 0.0;
  }
};

struct BlockCertificate {
  std::string name;
  bool tied = false;  // else: local frame, never certified
  int num_scans = 0;
  double path_length = 0.0;
  int num_loops = 0;
  int num_control_points = 0;
  int num_control_marks = 0;
  double rigid_scale = 1.0;
  double sigma_zero = 0.0;
  int degrees_of_freedom = 0;
  double fit_rms = 0.0;        // of the residuals at used control: not an accuracy
  double rigid_fit_rms = 0.0;  // the same before the adjustment
  AccuracyTest points;         // tested on check points
  AccuracyTest features;       // tested on check features
  std::optional<RelativeAccuracy> relative;
  NavigatedTimes navigated;
  std::vector<std::string> breaks;  // of the track, for people: the block is not demonstrated to meet a class
  std::optional<BlockReview> review;
};

// Differences of features that two blocks show.
struct StitchingPair {
  std::string block_a, block_b;
  std::string feature;
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();  // position in a - position in b
};

// How the rasters of two blocks agree where they overlap.
struct SeamSummary {
  std::string block_a, block_b;
  double overlap_area_m2 = 0.0;
  int num_windows = 0;              // places where an offset could be measured
  std::optional<double> rms;        // of the offsets that are known in both directions
  double contradicted_share = 0.0;  // wall cells of one map that the other saw as free, the worse of both
  std::optional<double> sigmas;     // length of the mean offset in sigmas of the two adjustments
  std::optional<bool> contradicts;  // beyond what their covariances allow; see JudgeSeam
};

struct StitchingAccuracy {
  std::vector<StitchingPair> pairs;
  double rms = 0.0;  // of the lengths of the differences, [CN] table 3
  double max = 0.0;
  std::vector<SeamSummary> seams;
};

struct Statement {
  std::string tested_on = "nothing";  // or "check features", "check points"
  int num_points = 0;
  std::string asprs;
  std::string nssda;
  std::optional<bool> meets;         // worst of all tests; empty without class or checks
  std::optional<bool> demonstrated;  // the same, at 95 % confidence
};

struct Certificate {
  std::string site;
  SiteFrame frame;
  std::string metric;             // sentence: grid or ground distances, the factor between them
  std::optional<double> class_m;  // RMSE_H asked for
  bool tied = false;              // at least one block is; otherwise this is a map report
  Statement statement;
  std::vector<ControlPoint> points;                     // the control list
  std::optional<AdjustmentSummary> control_adjustment;  // of the observations behind it
  std::vector<std::string> control_remarks;             // how its coordinates came into the site's system
  std::vector<BlockCertificate> blocks;
  std::vector<FitResidual> fit;
  std::vector<BlockReliability> reliability;  // of the control of tied blocks
  std::optional<CrossValidation> cross_validation;
  std::vector<TestedCheck> checks;
  AccuracyTest points_test;  // all tied blocks together
  AccuracyTest features_test;
  CheckAnalysis points_analysis;
  CheckAnalysis features_analysis;
  StitchingAccuracy stitching;
  std::optional<JointSummary> joint;              // empty: every block stands on its own control
  std::optional<DeliveryChanges> since_delivery;  // empty: nothing was delivered before
  std::optional<EditSummary> edits;               // empty: nobody edited a map
  std::vector<std::string> not_tested;            // sentences
};

}  // namespace survey
