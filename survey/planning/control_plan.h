// SPDX-License-Identifier: Apache-2.0
//
// How accurate a block will be with how many control points, and where they serve best: from the covariance of its free
// network alone, before anything is surveyed. With C the covariance of the free network, y the marked places, x a pose,
// W = (C_yy + S)^-1 and G the derivatives by a rigid motion, the pose's covariance after tying is
//   C_xx - C_xy W C_yx + D (G_y' W G_y)^-1 D',   D = G_x - C_xy W G_y.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "survey/graph/pose_graph.h"

namespace survey {

struct ControlPlanOptions {
  double candidate_spacing_m = 5.0;  // path between places where a point could be
  double path_spacing_m = 2.0;       // path between the poses whose accuracy counts
  double control_sigma_m = 0.003;    // of a control point, 1 sigma per axis
  double mark_sigma_m = 0.005;       // of the platform on it, 1 sigma per axis
  int max_points = 12;
};

// Accuracy after one more point.
struct PlanStep {
  int pose = 0;                                     // of the graph, at the new point
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // in the graph's frame
  double rms = 0.0;                                 // sqrt of the mean of sigma_x^2 + sigma_y^2 over the path, m
  double max = 0.0;                                 // largest of the path, m
};

struct ControlPlan {
  std::vector<PlanStep> steps;        // from the second point on they have an accuracy; the first has none (0)
  std::vector<int> path;              // poses of the path
  std::vector<double> sigma_of_path;  // sqrt(sigma_x^2 + sigma_y^2) with all steps, m
};

// Chosen one by one, each the candidate that leaves the smallest rms; the first two together. `graph`: free solution,
// poses from `first_node` on are the path. `taken`: poses where points are already, used first. Empty when the network
// is singular or has fewer than two candidates.
std::optional<ControlPlan> PlanControl(const PoseGraph& graph, int first_node, const std::vector<int>& taken,
                                       const ControlPlanOptions& options);

}  // namespace survey
