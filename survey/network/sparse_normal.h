// SPDX-License-Identifier: Apache-2.0
//
// The normal equations of a large network: sparse Cholesky factor and those elements of the inverse that standard
// deviations and redundancy numbers need [Takahashi73]. Singular equations are told from regular ones by the pivots of
// the equilibrated matrix.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <vector>

#include "survey/graph/selected_inverse.h"

namespace survey {

class SparseNormal {
 public:
  // Unknowns in `held` keep their values: they are left out and have zero cofactors.
  SparseNormal(const Eigen::SparseMatrix<double>& normal, const std::vector<int>& held);

  // Of a singular matrix: an unknown vector that the equations leave undetermined (largest element 1); empty when
  // regular.
  const Eigen::VectorXd& undetermined() const { return undetermined_; }

  Eigen::VectorXd Solve(const Eigen::VectorXd& side) const;

  // Precondition: regular.
  void InvertSubset();
  // Element of the inverse. Precondition: InvertSubset was called, and i and j stand together in an observation.
  double InverseAt(int i, int j) const;

 private:
  using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>>;

  void Equilibrate(const Eigen::SparseMatrix<double>& normal);
  void FindUndetermined();
  Eigen::VectorXd Spread(const Eigen::VectorXd& scaled) const;  // to all unknowns, zero for held ones

  int size_ = 0;
  std::vector<int> reduced_;  // by unknown: its number without the held ones, or -1 when held
  std::vector<int> unknown_;  // and back
  Eigen::VectorXd scale_;     // equilibrated = scale * normal * scale, lower triangle
  Eigen::SparseMatrix<double> equilibrated_;
  std::unique_ptr<Factor> factor_;
  std::optional<SelectedInverse> inverse_;
  Eigen::VectorXd undetermined_;
};

}  // namespace survey
