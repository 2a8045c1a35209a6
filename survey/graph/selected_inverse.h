// SPDX-License-Identifier: Apache-2.0
//
// Elements of the inverse of a sparse, symmetric, positive definite matrix where its Cholesky factor is not zero, by
// the recursion of [Takahashi73]: about the work of the factorisation, however many of them are wanted. That is every
// covariance of one pose and of two poses that an observation joins.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

namespace survey {

using SparseFactor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

class SelectedInverse {
 public:
  // `lower`: the lower triangle of the matrix. Empty when it is not positive definite.
  static std::optional<SelectedInverse> Of(const Eigen::SparseMatrix<double>& lower);
  // The same with the factorisation of `lower` that the caller has.
  static std::optional<SelectedInverse> Of(const Eigen::SparseMatrix<double>& lower, const SparseFactor& factor);

  // Element of the inverse; row and column must be equal or joined in the matrix (or by fill-in), otherwise zero.
  double operator()(int row, int column) const;

  // Rows x Columns elements from (row, column) on.
  template <int Rows, int Columns>
  Eigen::Matrix<double, Rows, Columns> Block(int row, int column) const {
    Eigen::Matrix<double, Rows, Columns> block;
    for (int i = 0; i < Rows; ++i) {
      for (int j = 0; j < Columns; ++j) block(i, j) = (*this)(row + i, column + j);
    }
    return block;
  }

 private:
  std::vector<int> position_;  // in the fill-reducing order, by row
  std::vector<int> begin_;     // of each column's elements below the diagonal
  std::vector<int> rows_;      // ascending within a column
  std::vector<double> below_;  // the inverse below the diagonal
  std::vector<double> diagonal_;
};

}  // namespace survey
