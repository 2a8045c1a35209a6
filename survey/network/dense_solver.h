// SPDX-License-Identifier: Apache-2.0
//
// The second solver, for small networks and as a check of the first: complete orthogonal decomposition of the whole
// design matrix, the rank by its pivots, the datum through its null space. It shares the observation equations with
// the sparse solver, but neither the normal equations nor the knowledge of shifts and rotations.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/network/linear_system.h"

namespace survey {

struct DenseSolution {
  bool usable = false;
  int defect = 0;
  Eigen::VectorXd correction;
  Eigen::MatrixXd cofactors;
};

// `shift_so_far`: of the unknowns from their approximate values; the defining coordinates' total shift becomes
// smallest. Not usable when the defining coordinates do not settle the null space.
DenseSolution SolveDense(const LinearSystem& system, const std::vector<bool>& defines,
                         const Eigen::VectorXd& shift_so_far);

}  // namespace survey
