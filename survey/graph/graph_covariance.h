// SPDX-License-Identifier: Apache-2.0
//
// Covariances of a pose graph at its solution: elements of the inverse of the normal matrix of all observations,
// without the robust loss. A held pose has none (zero).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "survey/graph/normal_equations.h"
#include "survey/graph/pose_graph.h"
#include "survey/graph/selected_inverse.h"

namespace survey {

class GraphCovariance {
 public:
  // Empty when the normal matrix is singular: no datum, or a pose that nothing holds.
  static std::optional<GraphCovariance> Of(const PoseGraph& graph);

  // x, y (m), theta (rad) in the graph's frame.
  Eigen::Matrix3d OfPose(int pose) const;

  // Share of an edge's three measured values that the others control: redundancy numbers r_i, 0 (nothing would show an
  // error) to 1, summed over the edge. [Baarda68]: the trace of I - A Q A' P.
  double RedundancyOf(const PoseEdge& edge) const;

  // Moves a copy of the graph by the Gauss-Newton step that the same factorisation gives: near the minimum, to it.
  void TakeStep(PoseGraph* graph) const;

  // Of the residual of an edge of the graph: what was measured minus what was adjusted.
  Eigen::Matrix3d OfResidual(const PoseEdge& edge) const;

 private:
  GraphCovariance(const PoseGraph& graph, NormalColumns columns, SelectedInverse inverse, Eigen::VectorXd step)
      : graph_(&graph), columns_(std::move(columns)), inverse_(std::move(inverse)), step_(std::move(step)) {}

  Eigen::Matrix3d Between(int pose, int other) const;
  Eigen::Matrix3d OfAdjusted(const PoseEdge& edge) const;

  const PoseGraph* graph_;  // must outlive this
  NormalColumns columns_;
  SelectedInverse inverse_;
  Eigen::VectorXd step_;
};

// Of a marked place in the graph's frame: the covariance of its pose carried through the lever arm, and the centring.
Eigen::Matrix2d CovarianceOfMark(const MarkEdge& mark, const Pose2& pose, const Eigen::Matrix3d& covariance);

}  // namespace survey
