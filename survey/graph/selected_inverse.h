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

// In the order of the matrix.
using OrderedFactor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

class SelectedInverse {
 public:
  // `lower`: the lower triangle of the matrix. Empty when it is not positive definite.
  static std::optional<SelectedInverse> Of(const Eigen::SparseMatrix<double>& lower);
  // The same with the factorisation of `lower` that the caller has.
  static std::optional<SelectedInverse> Of(const Eigen::SparseMatrix<double>& lower, const OrderedFactor& factor);

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
  // Neighbouring columns of the factor that are full among themselves and have the same rows below: of one pose at
  // least. `inverse`: their columns of the inverse in these rows, their own first.
  struct Panel {
    int first = 0;           // column
    std::vector<int> below;  // rows, ascending
    Eigen::MatrixXd inverse;

    int width() const { return static_cast<int>(inverse.cols()); }
    // Places in `inverse` of the rows from index `from` on, ascending, all of which it has.
    void FindPlaces(const std::vector<int>& rows, std::size_t from, std::vector<int>* places) const;
  };

  template <typename Factor>
  static std::optional<SelectedInverse> OfFactor(const Eigen::SparseMatrix<double>& lower, const Factor& factor);
  void AddPanel(const Eigen::SparseMatrix<double>& factor, int first, int width);
  void Invert(const Eigen::SparseMatrix<double>& factor, const Eigen::VectorXd& pivots, Panel* panel) const;
  const Panel& PanelOf(int column) const {
    return panels_[static_cast<std::size_t>(panel_of_[static_cast<std::size_t>(column)])];
  }
  Eigen::MatrixXd InverseAmong(const std::vector<int>& rows) const;

  std::vector<int> position_;  // in the fill-reducing order, by row
  std::vector<int> panel_of_;  // by column in that order
  std::vector<Panel> panels_;
};

}  // namespace survey
