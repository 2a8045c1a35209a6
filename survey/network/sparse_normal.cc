// SPDX-License-Identifier: Apache-2.0
#include "survey/network/sparse_normal.h"

#include <cmath>

namespace survey {
namespace {

constexpr double kSingularPivot = 1e-12;  // of an equilibrated matrix

}  // namespace

SparseNormal::SparseNormal(const Eigen::SparseMatrix<double>& normal, const std::vector<int>& held)
    : size_(static_cast<int>(normal.rows())),
      reduced_(static_cast<std::size_t>(normal.rows()), 0),
      factor_(std::make_unique<Factor>()) {
  for (const int k : held) reduced_[static_cast<std::size_t>(k)] = -1;
  for (int k = 0; k < size_; ++k) {
    int& reduced = reduced_[static_cast<std::size_t>(k)];
    if (reduced < 0) continue;
    reduced = static_cast<int>(unknown_.size());
    unknown_.push_back(k);
  }
  Equilibrate(normal);
  factor_->compute(equilibrated_);
  if (factor_->info() != Eigen::Success) {  // a zero pivot stops it: a small shift lets it pass
    factor_->setShift(kSingularPivot / 100.0, 1.0);
    factor_->compute(equilibrated_);
  }
  FindUndetermined();
}

void SparseNormal::Equilibrate(const Eigen::SparseMatrix<double>& normal) {
  const auto count = static_cast<Eigen::Index>(unknown_.size());
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
  equilibrated_.resize(count, count);
  equilibrated_.setFromTriplets(entries.begin(), entries.end());
}

// With the smallest pivot at p: L' z = e_p makes N z = pivot * L e_p, nearly zero.
void SparseNormal::FindUndetermined() {
  const Eigen::VectorXd pivots = factor_->vectorD();
  Eigen::Index p = 0;
  if (pivots.size() == 0 || pivots.minCoeff(&p) > kSingularPivot) return;
  Eigen::VectorXd z = Eigen::VectorXd::Unit(pivots.size(), p);
  factor_->matrixU().solveInPlace(z);
  undetermined_ = Spread(factor_->permutationPinv() * z);
  undetermined_ /= undetermined_.cwiseAbs().maxCoeff();
}

Eigen::VectorXd SparseNormal::Spread(const Eigen::VectorXd& scaled) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size_);
  for (std::size_t r = 0; r < unknown_.size(); ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    all[unknown_[r]] = scaled[row] * scale_[row];
  }
  return all;
}

Eigen::VectorXd SparseNormal::Solve(const Eigen::VectorXd& side) const {
  Eigen::VectorXd scaled(scale_.size());
  for (Eigen::Index r = 0; r < scaled.size(); ++r) {
    scaled[r] = side[unknown_[static_cast<std::size_t>(r)]] * scale_[r];
  }
  return Spread(factor_->solve(scaled));
}

void SparseNormal::InvertSubset() { inverse_ = SelectedInverse::Of(equilibrated_); }

double SparseNormal::InverseAt(int i, int j) const {
  const int a = reduced_[static_cast<std::size_t>(i)], b = reduced_[static_cast<std::size_t>(j)];
  if (a < 0 || b < 0) return 0.0;
  return (*inverse_)(a, b) * scale_[a] * scale_[b];
}

}  // namespace survey
