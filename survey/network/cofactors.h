// SPDX-License-Identifier: Apache-2.0
//
// The cofactor matrix of the unknowns in the network's datum (their covariance for sigma zero = 1), by either solver.
#pragma once

#include <Eigen/Core>

#include "survey/network/datum.h"
#include "survey/network/sparse_normal.h"

namespace survey {

class Cofactors {
 public:
  virtual ~Cofactors() = default;
  virtual double At(int i, int j) const = 0;  // of unknowns that stand together in an observation
  virtual Eigen::VectorXd Column(int j) const = 0;
};

class DenseCofactors : public Cofactors {
 public:
  explicit DenseCofactors(Eigen::MatrixXd matrix) : matrix_(std::move(matrix)) {}
  double At(int i, int j) const override { return matrix_(i, j); }
  Eigen::VectorXd Column(int j) const override { return matrix_.col(j); }

 private:
  Eigen::MatrixXd matrix_;
};

// S Q S' with the sparse inverse Q of the equations in which some unknowns are held. Of Q only the subset and
// one solution for each motion of the datum are needed.
class SparseCofactors : public Cofactors {
 public:
  SparseCofactors(SparseNormal normal, DatumTransformation transformation);
  double At(int i, int j) const override;
  Eigen::VectorXd Column(int j) const override;

 private:
  SparseNormal normal_;
  DatumTransformation transformation_;
  Eigen::MatrixXd q_selector_;  // Q A'
  Eigen::MatrixXd inner_;       // A Q A'
};

}  // namespace survey
