// SPDX-License-Identifier: Apache-2.0
#include "survey/network/dense_solver.h"

#include <Eigen/QR>

namespace survey {
namespace {

constexpr double kRank = 1e-9;  // of pivots of the equilibrated matrix, relative to the largest

}  // namespace

DenseSolution SolveDense(const LinearSystem& system, const std::vector<bool>& defines,
                         const Eigen::VectorXd& shift_so_far) {
  DenseSolution solution;
  Eigen::MatrixXd jacobian = system.DenseJacobian();
  Eigen::VectorXd scale = jacobian.colwise().norm().transpose();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 1.0;
  jacobian *= scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kRank);
  decomposition.compute(jacobian);
  solution.defect = static_cast<int>(jacobian.cols() - decomposition.rank());
  const Eigen::MatrixXd range = scale.asDiagonal() * decomposition.pseudoInverse();
  Eigen::VectorXd total = shift_so_far + range * system.Misclosures();
  Eigen::MatrixXd root = range;  // cofactors = root root'
  if (solution.defect > 0) {
    const Eigen::MatrixXd unscaled =
        decomposition.colsPermutation() * decomposition.matrixZ().bottomRows(solution.defect).transpose();
    const Eigen::MatrixXd null = scale.asDiagonal() * unscaled;
    Eigen::MatrixXd defining = null;
    for (Eigen::Index k = 0; k < null.rows(); ++k) {
      if (!defines[static_cast<std::size_t>(k)]) defining.row(k).setZero();
    }
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of_defining(defining);
    if (of_defining.rank() < solution.defect) return solution;
    // Least squares of the defining coordinates' shifts over the null space.
    const Eigen::MatrixXd shifts = null * of_defining.pseudoInverse();
    total -= shifts * total;
    root -= shifts * root;
  }
  solution.correction = total - shift_so_far;
  solution.cofactors = root * root.transpose();
  solution.usable = true;
  return solution;
}

}  // namespace survey
