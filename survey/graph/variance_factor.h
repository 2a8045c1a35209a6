// SPDX-License-Identifier: Apache-2.0
//
// How honest the a-priori covariances of a block's relative observations are. Memberships and motions are two copies of
// one track and fit each other whatever its errors; only the loops compare what was measured independently. Their
// residuals against their redundancy ([Foerstner79]) tell the factor that all these covariances were off by. One factor
// for all: the free solution stays as it is, and control meets it at its true weight.
#pragma once

#include "survey/graph/pose_graph.h"

namespace survey {

struct VarianceFactor {
  double factor = 1.0;      // of the covariances of all edges; 1 where too few loops tell
  double redundancy = 0.0;  // of the loops
  bool told = false;        // by enough loops
};

// Of a solved graph. `robust_scale` as in the solution: loops count by the weight that the loss left them.
VarianceFactor VarianceFactorOfLoops(const PoseGraph& graph, double robust_scale);

// Free solution: what the sensors alone say. Afterwards the covariances of all edges, and the costs, are those that the
// loops have confirmed.
struct FreeSolution {
  PoseGraphSummary summary;
  VarianceFactor factor;  // applied to the covariances
};
FreeSolution SolveFree(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace survey
