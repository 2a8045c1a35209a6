// SPDX-License-Identifier: Apache-2.0
//
// The normal equations of a large network: sparse Cholesky factor and those elements of the inverse that lie in the
// factor's pattern, which are all that standard deviations and redundancy numbers need [Takahashi73] [Erisman75].
// Singular equations are told from regular ones by the pivots of the equilibrated matrix.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace survey {

class SparseNormal {
 public:
  // Unknowns in `held` keep their values: they are left out and have zero cofactors.
  SparseNormal(const Eigen::SparseMatrix<double>& normal, const std::vector<int>& held);

  // Of a singular matrix: an unknown vector that the equations leave undetermined (largest element 1); empty when
  // regular.
  const Eigen::VectorXd& undetermined() const { return undetermined_; }

  Eigen::VectorXd Solve(const Eigen::VectorXd& side) const;

  void InvertSubset();
  // Element of the inverse. Precondition: InvertSubset was called, and i and j stand together in an observation.
  double InverseAt(int i, int j) const;

 private:
  void Factorise(const Eigen::SparseMatrix<double>& normal);
  void FindUndetermined();

  int size_ = 0;
  std::vector<int> reduced_;           // by unknown: its place in the factor's order, or -1 when held
  std::vector<int> unknown_;           // and back
  Eigen::VectorXd scale_;              // in the factor's order: equilibrated = scale * normal * scale
  Eigen::SparseMatrix<double> lower_;  // strict lower triangle of the unit factor, rows ascending in each column
  Eigen::VectorXd pivots_;
  Eigen::SparseMatrix<double> inverse_;  // strict lower triangle, same pattern
  Eigen::VectorXd inverse_diagonal_;
  Eigen::VectorXd undetermined_;
};

}  // namespace survey
