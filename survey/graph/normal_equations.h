// SPDX-License-Identifier: Apache-2.0
//
// The normal equations of a pose graph, linearised at its poses and points: N dx = b, with N = J' P J and b = -J' P e
// over all observations with their weights as they are (no robust loss). Columns: three for a pose (x, y in m, theta in
// rad), two for a point (m), in an order in which a factorisation fills little.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "survey/graph/pose_graph.h"

namespace survey {

// First columns of the unknowns.
struct NormalColumns {
  std::vector<int> of_pose;   // -1: the pose is held
  std::vector<int> of_point;  // -1: nothing observes the point
};

struct NormalEquations {
  NormalColumns columns;
  Eigen::SparseMatrix<double> lower;  // lower triangle of N
  Eigen::VectorXd right;              // b
};

NormalEquations FormNormalEquations(const PoseGraph& graph);

}  // namespace survey
