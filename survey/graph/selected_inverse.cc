// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/selected_inverse.h"

#include <algorithm>
#include <numeric>

namespace survey {
namespace {

using Eigen::Index;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kSmallestPivot = 1e-13;  // of the matrix's own diagonal: below, rounding is all that is left

// The factor below its diagonal of ones, which Eigen does not store.
std::vector<int> RowsOf(const Sparse& factor, int column) {
  std::vector<int> rows;
  for (Sparse::InnerIterator it(factor, column); it; ++it) rows.push_back(static_cast<int>(it.row()));
  return rows;
}

// Of the unknowns in the order of elimination.
template <typename Factor>
std::vector<int> PositionsIn(const Factor& factor, int num_unknowns) {
  const auto& permutation = factor.permutationP().indices();
  std::vector<int> positions(permutation.data(), permutation.data() + permutation.size());
  if (!positions.empty()) return positions;
  positions.resize(static_cast<std::size_t>(num_unknowns));  // their own order
  std::iota(positions.begin(), positions.end(), 0);
  return positions;
}

// How many columns from `first` on share the rows below them and are full among themselves.
int WidthOfPanel(const Sparse& factor, int first) {
  const auto rows = [&](int column) { return factor.innerVector(column).nonZeros(); };
  int last = first;
  while (last + 1 < factor.cols() && rows(last) > 0 &&
         factor.innerIndexPtr()[factor.outerIndexPtr()[last]] == last + 1 && rows(last) == rows(last + 1) + 1)
    ++last;
  return last + 1 - first;
}

}  // namespace

// With A = L D L', Z = A^-1, the columns J of a panel and the rows S below them where L is not zero:
//   Y = L_SJ L_JJ^-1,  Z_SJ = -Z_SS Y,  Z_JJ = (L_JJ D_J L_JJ')^-1 - Y' Z_SJ.
// All of Z_SS lies in panels behind and where L is not zero. So the panels follow from the last to the first.
template <typename Factor>
std::optional<SelectedInverse> SelectedInverse::OfFactor(const Sparse& lower, const Factor& factor) {
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd pivots = factor.vectorD();
  const int n = static_cast<int>(lower.cols());
  SelectedInverse inverse;
  inverse.position_ = PositionsIn(factor, n);
  for (int i = 0; i < n; ++i) {
    if (!(pivots(inverse.position_[static_cast<std::size_t>(i)]) > kSmallestPivot * lower.coeff(i, i)))
      return std::nullopt;
  }
  const Sparse& stored = factor.matrixL().nestedExpression();
  for (int first = 0; first < n; first += inverse.panels_.back().width())
    inverse.AddPanel(stored, first, WidthOfPanel(stored, first));
  for (auto panel = inverse.panels_.rbegin(); panel != inverse.panels_.rend(); ++panel)
    inverse.Invert(stored, pivots, &*panel);
  return inverse;
}

std::optional<SelectedInverse> SelectedInverse::Of(const Sparse& lower, const OrderedFactor& factor) {
  return OfFactor(lower, factor);
}

std::optional<SelectedInverse> SelectedInverse::Of(const Sparse& lower) {
  return OfFactor(lower, Eigen::SimplicialLDLT<Sparse, Eigen::Lower>(lower));
}

void SelectedInverse::AddPanel(const Sparse& factor, int first, int width) {
  Panel panel{.first = first, .below = RowsOf(factor, first + width - 1)};
  panel.inverse.resize(width + static_cast<Index>(panel.below.size()), width);
  panel_of_.insert(panel_of_.end(), static_cast<std::size_t>(width), static_cast<int>(panels_.size()));
  panels_.push_back(std::move(panel));
}

void SelectedInverse::Invert(const Sparse& factor, const Eigen::VectorXd& pivots, Panel* panel) const {
  const Index width = panel->width();
  const Index rows = panel->inverse.rows() - width;
  Eigen::MatrixXd own = Eigen::MatrixXd::Identity(width, width);  // L_JJ
  Eigen::MatrixXd below(rows, width);                             // L_SJ
  for (Index j = 0; j < width; ++j) {
    Sparse::InnerIterator it(factor, panel->first + j);
    for (Index i = j + 1; i < width; ++i, ++it) own(i, j) = it.value();
    for (Index i = 0; i < rows; ++i, ++it) below(i, j) = it.value();
  }
  const Eigen::MatrixXd own_inverse =
      own.triangularView<Eigen::UnitLower>().solve(Eigen::MatrixXd::Identity(width, width));
  const Eigen::MatrixXd y = below * own_inverse;
  panel->inverse.bottomRows(rows).noalias() = -InverseAmong(panel->below) * y;
  panel->inverse.topRows(width) =
      own_inverse.transpose() * pivots.segment(panel->first, width).cwiseInverse().asDiagonal() * own_inverse -
      y.transpose() * panel->inverse.bottomRows(rows);
}

// Z_SS, from the panels of its columns.
Eigen::MatrixXd SelectedInverse::InverseAmong(const std::vector<int>& rows) const {
  const std::size_t size = rows.size();
  Eigen::MatrixXd among(size, size);
  std::vector<int> places(size);
  for (std::size_t j = 0; j < size;) {
    const Panel& panel = PanelOf(rows[j]);
    panel.FindPlaces(rows, j, &places);
    for (; j < size && rows[j] < panel.first + panel.width(); ++j) {
      const auto column = static_cast<Index>(j);
      for (std::size_t i = j; i < size; ++i)
        among(static_cast<Index>(i), column) = among(column, static_cast<Index>(i)) =
            panel.inverse(places[i], rows[j] - panel.first);
    }
  }
  return among;
}

void SelectedInverse::Panel::FindPlaces(const std::vector<int>& rows, std::size_t from,
                                        std::vector<int>* places) const {
  auto next = below.begin();
  for (std::size_t i = from; i < rows.size(); ++i) {
    if (rows[i] < first + width()) {
      (*places)[i] = rows[i] - first;
      continue;
    }
    while (*next < rows[i]) ++next;  // all are among them
    (*places)[i] = width() + static_cast<int>(next - below.begin());
  }
}

double SelectedInverse::operator()(int row, int column) const {
  const int a = position_[static_cast<std::size_t>(row)];
  const int b = position_[static_cast<std::size_t>(column)];
  const int last = std::max(a, b);
  const Panel& panel = PanelOf(std::min(a, b));
  const int in_panel = std::min(a, b) - panel.first;
  if (last < panel.first + panel.width()) return panel.inverse(last - panel.first, in_panel);
  const auto found = std::lower_bound(panel.below.begin(), panel.below.end(), last);
  if (found == panel.below.end() || *found != last) return 0.0;
  return panel.inverse(panel.width() + (found - panel.below.begin()), in_panel);
}

}  // namespace survey
