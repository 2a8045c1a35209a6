// SPDX-License-Identifier: Apache-2.0
#include "survey/network/dense_solver.h"

#include <Eigen/Dense>

namespace survey {
namespace {

constexpr double kRank = 1e-9;  // of singular values of the equilibrated matrix, relative to the largest

}  // namespace

DenseSolution SolveDense(const LinearSystem& system, const std::vector<bool>& defines,
                         const Eigen::VectorXd& shift_so_far) {
  DenseSolution solution;
  Eigen::MatrixXd jacobian = system.DenseJacobian();
  Eigen::VectorXd scale = jacobian.colwise().norm().transpose();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 1.0;
  jacobian *= scale.asDiagonal();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinU | Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < svd.singularValues().size() && svd.singularValues()[rank] > kRank * svd.singularValues()[0]) ++rank;
  solution.defect = static_cast<int>(jacobian.cols() - rank);
  const Eigen::MatrixXd range =
      scale.asDiagonal() * svd.matrixV().leftCols(rank) * svd.singularValues().head(rank).cwiseInverse().asDiagonal();
  Eigen::VectorXd total = shift_so_far + range * (svd.matrixU().leftCols(rank).transpose() * system.Misclosures());
  Eigen::MatrixXd root = range;  // cofactors = root root'
  if (solution.defect > 0) {
    const Eigen::MatrixXd null = scale.asDiagonal() * svd.matrixV().rightCols(solution.defect);
    Eigen::MatrixXd defining = null;
    for (Eigen::Index k = 0; k < null.rows(); ++k) {
      if (!defines[static_cast<std::size_t>(k)]) defining.row(k).setZero();
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(defining);
    if (qr.rank() < solution.defect) return solution;
    // Least squares of the defining coordinates' shifts over the null space.
    total -= null * qr.solve(total);
    root -= null * qr.solve(root);
  }
  solution.correction = total - shift_so_far;
  solution.cofactors = root * root.transpose();
  solution.usable = true;
  return solution;
}

}  // namespace survey
