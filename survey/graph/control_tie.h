// SPDX-License-Identifier: Apache-2.0
//
// Ties the graph of a block to its control points, in a surveyor's order: rigid fit on the marks, tests of the marks
// against each other by the free network, blunders left out one at a time, constrained adjustment of the rest, tests
// again at its solution, until both agree on what is left out. [CN] section 2.3, [Baarda68].
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/pose_graph.h"
#include "survey/graph/solution.h"
#include "survey/graph/variance_components.h"
#include "survey/stats/reliability.h"

namespace survey {

struct ControlTieOptions {
  PoseGraphOptions solver;
  TestLevel test;
  double family_significance = 0.005;  // probability that a block without blunders loses a mark
};

struct TiedMark {
  bool on_control = false;
  bool used = false;
  Eigen::Vector2d given = Eigen::Vector2d::Zero();  // coordinates of its control point, site frame
  Eigen::Vector2d rigid = Eigen::Vector2d::Zero();  // place after the rigid fit alone
  std::string left_out;
  std::optional<MarkTest> test;
};

struct ControlTie {
  bool usable = false;
  std::string message;                               // why not
  Pose2 site_from_local;                             // rigid fit on the marks that were used
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // graph frame plus offset is the site frame: keeps digits
  std::vector<TiedMark> marks;                       // in the graph's order
  double network_factor = 1.0;                       // by which control multiplied the covariances of the network
  PoseGraphSummary summary;                          // of the constrained adjustment
  ControlVerdict verdict;
  VarianceComponent of_control;
  std::vector<std::string> findings;
};

// Displacement of the marked place from the scan of graph mark `mark` to `seconds` later, in the frame of that scan.
using MotionInScan = std::function<std::optional<Eigen::Vector2d>(std::size_t mark, double seconds)>;

// `block`: the free solution in the local frame, its loops at their final weights; afterwards the constrained solution.
// The marks lie on two control points or more. `of_network`: the factors that the free solution applied; where too few
// loops told, control multiplies the network's covariances.
ControlTie TieToControl(const ControlNetwork& control, const ControlTieOptions& options,
                        const NetworkFactors& of_network, const MotionInScan& motion, BlockGraph* block);

}  // namespace survey
