// SPDX-License-Identifier: Apache-2.0
#include "survey/network/cofactors.h"

namespace survey {

SparseCofactors::SparseCofactors(SparseNormal normal, DatumTransformation transformation)
    : normal_(std::move(normal)), transformation_(std::move(transformation)) {
  normal_.InvertSubset();
  const Eigen::MatrixXd& selector = transformation_.selector();
  q_selector_.resize(selector.rows(), selector.cols());
  for (Eigen::Index k = 0; k < selector.cols(); ++k) q_selector_.col(k) = normal_.Solve(selector.col(k));
  inner_ = selector.transpose() * q_selector_;
}

double SparseCofactors::At(int i, int j) const {
  double q = normal_.InverseAt(i, j);
  if (inner_.size() == 0) return q;
  const auto basis_i = transformation_.basis().row(i), basis_j = transformation_.basis().row(j);
  q -= basis_i.dot(q_selector_.row(j)) + basis_j.dot(q_selector_.row(i));
  return q + basis_i * inner_ * basis_j.transpose();
}

Eigen::VectorXd SparseCofactors::Column(int j) const {
  const Eigen::MatrixXd& selector = transformation_.selector();
  Eigen::VectorXd unit = Eigen::VectorXd::Unit(selector.rows(), j);
  if (inner_.size() > 0) unit -= selector * transformation_.basis().row(j).transpose();
  return transformation_(normal_.Solve(unit));
}

}  // namespace survey
