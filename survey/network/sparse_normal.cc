// SPDX-License-Identifier: Apache-2.0
#include "survey/network/sparse_normal.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr double kSingularPivot = 1e-12;  // of an equilibrated matrix

}  // namespace

SparseNormal::SparseNormal(const Eigen::SparseMatrix<double>& normal, const std::vector<int>& held)
    : size_(static_cast<int>(normal.rows())), reduced_(static_cast<std::size_t>(normal.rows()), 0) {
  for (const int k : held) reduced_[static_cast<std::size_t>(k)] = -1;
  for (int k = 0; k < size_; ++k) {
    if (reduced_[static_cast<std::size_t>(k)] >= 0) unknown_.push_back(k);
  }
  Factorise(normal);
}

void SparseNormal::Factorise(const Eigen::SparseMatrix<double>& normal) {
  const auto count = static_cast<Eigen::Index>(unknown_.size());
  for (std::size_t r = 0; r < unknown_.size(); ++r) {
    reduced_[static_cast<std::size_t>(unknown_[r])] = static_cast<int>(r);
  }
  scale_.resize(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const int k = unknown_[static_cast<std::size_t>(r)];
    const double diagonal = normal.coeff(k, k);
    scale_[r] = diagonal > 0.0 ? 1.0 / std::sqrt(diagonal) : 1.0;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < size_; ++column) {
    const int c = reduced_[static_cast<std::size_t>(column)];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(normal, column); c >= 0 && entry; ++entry) {
      const int r = reduced_[static_cast<std::size_t>(entry.row())];
      if (r >= c) entries.emplace_back(r, c, entry.value() * scale_[r] * scale_[c]);
    }
  }
  Eigen::SparseMatrix<double> equilibrated(count, count);
  equilibrated.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> factor;
  // Undetermined unknowns give zero pivots, at which the factorisation would stop: a small shift lets it pass.
  factor.setShift(0.0, 1.0);
  factor.compute(equilibrated);
  if (factor.info() != Eigen::Success) {
    factor.setShift(kSingularPivot / 100.0, 1.0);
    factor.compute(equilibrated);
  }
  // Renumber everything into the order of elimination.
  const auto& order = factor.permutationP().indices();
  std::vector<int> in_order(unknown_.size());
  Eigen::VectorXd scale(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    in_order[static_cast<std::size_t>(order[r])] = unknown_[static_cast<std::size_t>(r)];
    scale[order[r]] = scale_[r];
  }
  unknown_ = in_order;
  scale_ = scale;
  for (std::size_t r = 0; r < unknown_.size(); ++r) {
    reduced_[static_cast<std::size_t>(unknown_[r])] = static_cast<int>(r);
  }
  lower_ = Eigen::SparseMatrix<double>(factor.matrixL()).triangularView<Eigen::StrictlyLower>();
  pivots_ = factor.vectorD();
  FindUndetermined();
}

// With the smallest pivot at p: L' z = e_p makes N z = pivot * L e_p, nearly zero.
void SparseNormal::FindUndetermined() {
  if (pivots_.size() == 0) return;
  Eigen::Index p = 0;
  if (pivots_.minCoeff(&p) > kSingularPivot) return;
  Eigen::VectorXd z = Eigen::VectorXd::Unit(pivots_.size(), p);
  for (Eigen::Index column = p; column-- > 0;) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower_, column); entry; ++entry) {
      z[column] -= entry.value() * z[entry.row()];
    }
  }
  z = z.cwiseProduct(scale_);
  undetermined_ = Eigen::VectorXd::Zero(size_);
  const double largest = z.cwiseAbs().maxCoeff();
  for (std::size_t r = 0; r < unknown_.size(); ++r) {
    undetermined_[unknown_[r]] = z[static_cast<Eigen::Index>(r)] / largest;
  }
}

Eigen::VectorXd SparseNormal::Solve(const Eigen::VectorXd& side) const {
  const Eigen::Index count = pivots_.size();
  Eigen::VectorXd y(count);
  for (Eigen::Index r = 0; r < count; ++r) y[r] = side[unknown_[static_cast<std::size_t>(r)]] * scale_[r];
  for (Eigen::Index column = 0; column < count; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower_, column); entry; ++entry) {
      y[entry.row()] -= entry.value() * y[column];
    }
  }
  y = y.cwiseQuotient(pivots_);
  for (Eigen::Index column = count; column-- > 0;) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower_, column); entry; ++entry) {
      y[column] -= entry.value() * y[entry.row()];
    }
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size_);
  for (Eigen::Index r = 0; r < count; ++r) x[unknown_[static_cast<std::size_t>(r)]] = y[r] * scale_[r];
  return x;
}

// [Erisman75]: Z = D^-1 L^-1 + (I - L') Z, column by column from the last; each step needs only elements of Z that are
// in the pattern of L.
void SparseNormal::InvertSubset() {
  const Eigen::Index count = pivots_.size();
  inverse_ = lower_;
  inverse_diagonal_.resize(count);
  std::vector<double> sum(static_cast<std::size_t>(count), 0.0);
  std::vector<double> factor(static_cast<std::size_t>(count), 0.0);
  std::vector<Eigen::Index> in_column(static_cast<std::size_t>(count), -1);  // the column whose rows are marked
  const int* begin = lower_.outerIndexPtr();
  const int* rows = lower_.innerIndexPtr();
  const double* l = lower_.valuePtr();
  double* z = inverse_.valuePtr();
  for (Eigen::Index j = count; j-- > 0;) {
    for (int e = begin[j]; e < begin[j + 1]; ++e) {
      const auto row = static_cast<std::size_t>(rows[e]);
      sum[row] = 0.0;
      factor[row] = l[e];
      in_column[row] = j;
    }
    for (int e = begin[j]; e < begin[j + 1]; ++e) {
      const int k = rows[e];
      const auto at_k = static_cast<std::size_t>(k);
      double sum_k = sum[at_k] + inverse_diagonal_[k] * l[e];
      for (int f = begin[k]; f < begin[k + 1]; ++f) {
        const auto row = static_cast<std::size_t>(rows[f]);
        if (in_column[row] != j) continue;
        sum[row] += z[f] * l[e];
        sum_k += z[f] * factor[row];
      }
      sum[at_k] = sum_k;
    }
    double diagonal = 1.0 / pivots_[j];
    for (int e = begin[j]; e < begin[j + 1]; ++e) {
      z[e] = -sum[static_cast<std::size_t>(rows[e])];
      diagonal -= z[e] * l[e];
    }
    inverse_diagonal_[j] = diagonal;
  }
}

double SparseNormal::InverseAt(int i, int j) const {
  const int a = reduced_[static_cast<std::size_t>(i)], b = reduced_[static_cast<std::size_t>(j)];
  if (a < 0 || b < 0) return 0.0;
  const double scale = scale_[a] * scale_[b];
  if (a == b) return inverse_diagonal_[a] * scale;
  const int row = std::max(a, b), column = std::min(a, b);
  const int* first = inverse_.innerIndexPtr() + inverse_.outerIndexPtr()[column];
  const int* last = inverse_.innerIndexPtr() + inverse_.outerIndexPtr()[column + 1];
  const int* found = std::lower_bound(first, last, row);
  return inverse_.valuePtr()[found - inverse_.innerIndexPtr()] * scale;
}

}  // namespace survey
