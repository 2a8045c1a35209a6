// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/selected_inverse.h"

#include <algorithm>

namespace survey {

// With A = L D L' and Z = A^-1: Z = D^-1 L^-1 + (I - L') Z. Below the diagonal of column j this reads
// z_ij = -sum_k z_ik l_kj over the rows k of column j of L, on the diagonal z_jj = 1 / d_j - sum_k z_kj l_kj; all z_ik
// that occur lie in columns behind j and where L is not zero. So the columns follow from the last to the first.
std::optional<SelectedInverse> SelectedInverse::Of(const Eigen::SparseMatrix<double>& lower,
                                                   const SparseFactor& factor) {
  constexpr double kSmallestPivot = 1e-13;  // of the matrix's own diagonal: below, rounding is all that is left
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd pivots = factor.vectorD();
  const auto& permutation = factor.permutationP().indices();
  const int n = static_cast<int>(lower.cols());
  for (int i = 0; i < n; ++i) {
    if (!(pivots(permutation(i)) > kSmallestPivot * lower.coeff(i, i))) return std::nullopt;
  }
  const auto& stored = factor.matrixL().nestedExpression();

  SelectedInverse inverse;
  inverse.position_.assign(permutation.data(), permutation.data() + n);
  inverse.begin_.assign(1, 0);
  std::vector<double> factor_below;
  for (int j = 0; j < n; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(stored, j); it; ++it) {
      if (it.row() <= j) continue;
      inverse.rows_.push_back(static_cast<int>(it.row()));
      factor_below.push_back(it.value());
    }
    inverse.begin_.push_back(static_cast<int>(inverse.rows_.size()));
  }
  inverse.below_.resize(inverse.rows_.size());
  inverse.diagonal_.resize(static_cast<std::size_t>(n));

  std::vector<double> of_column(static_cast<std::size_t>(n), 0.0);  // l_kj by k, zero elsewhere
  std::vector<double> product(static_cast<std::size_t>(n), 0.0);    // sum of z_ik l_kj by i
  for (int j = n - 1; j >= 0; --j) {
    const auto first = static_cast<std::size_t>(inverse.begin_[static_cast<std::size_t>(j)]);
    const auto last = static_cast<std::size_t>(inverse.begin_[static_cast<std::size_t>(j) + 1]);
    for (std::size_t e = first; e < last; ++e) {
      of_column[static_cast<std::size_t>(inverse.rows_[e])] = factor_below[e];
      product[static_cast<std::size_t>(inverse.rows_[e])] = 0.0;
    }
    for (std::size_t e = first; e < last; ++e) {
      const auto k = static_cast<std::size_t>(inverse.rows_[e]);
      double sum = inverse.diagonal_[k] * factor_below[e];
      const auto end = static_cast<std::size_t>(inverse.begin_[k + 1]);
      for (auto f = static_cast<std::size_t>(inverse.begin_[k]); f < end; ++f) {
        const auto i = static_cast<std::size_t>(inverse.rows_[f]);
        sum += inverse.below_[f] * of_column[i];
        product[i] += inverse.below_[f] * factor_below[e];
      }
      product[k] += sum;
    }
    double diagonal = 1.0 / pivots(j);
    for (std::size_t e = first; e < last; ++e) {
      const auto i = static_cast<std::size_t>(inverse.rows_[e]);
      inverse.below_[e] = -product[i];
      diagonal += product[i] * factor_below[e];
      of_column[i] = 0.0;
    }
    inverse.diagonal_[static_cast<std::size_t>(j)] = diagonal;
  }
  return inverse;
}

std::optional<SelectedInverse> SelectedInverse::Of(const Eigen::SparseMatrix<double>& lower) {
  return Of(lower, SparseFactor(lower));
}

double SelectedInverse::operator()(int row, int column) const {
  const int a = position_[static_cast<std::size_t>(row)];
  const int b = position_[static_cast<std::size_t>(column)];
  if (a == b) return diagonal_[static_cast<std::size_t>(a)];
  const auto c = static_cast<std::size_t>(std::min(a, b));
  const auto begin = rows_.begin() + begin_[c];
  const auto end = rows_.begin() + begin_[c + 1];
  const auto found = std::lower_bound(begin, end, std::max(a, b));
  return found != end && *found == std::max(a, b) ? below_[static_cast<std::size_t>(found - rows_.begin())] : 0.0;
}

}  // namespace survey
