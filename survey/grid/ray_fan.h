// SPDX-License-Identifier: Apache-2.0
//
// The cells that the rays of one scan cross, row by row: the same cells that line_cells.h visits ray by ray, each once.
//
// All rays start at one point, so within a row they lie in the order of their slopes. Neighbours that both cross the
// row and leave no whole cell between them fuse to a run, whose first and last ray alone bound the cells of all; where
// beams are dense the cost is that of the outline, not of the area. Rays that have drawn apart are runs of their own,
// and a ray that ends splits its run, so that nothing behind the nearer of two neighbouring end points is claimed.
//
// Coordinates in cells; column and row numbers must not be negative.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "survey/grid/row_lists.h"

namespace survey {

// Columns first ... last, both included.
struct ColumnSpan {
  int first;
  int last;
};

class RayFan {
 public:
  // Forgets all rays. The new ones start at (x, y).
  void Begin(double x, double y);

  // A ray to (x, y), which lies in cell (column, row). That cell is not part of the ray.
  void Add(double x, double y, int column, int row);

  // Calls visit(row, spans) once for every row from low_row to high_row, outwards from the origin's row on each side.
  // All rays must lie in these rows. The spans of a row may overlap; there may be none.
  template <typename Visit>
  void ForEachRow(int low_row, int high_row, const Visit& visit) {
    above_.Arrange(first_above_, high_row - row_);
    below_.Arrange(first_below_, row_ - low_row);
    above_.AppendSpans(0, x_, &spans_);
    below_.AppendSpans(0, x_, &spans_);
    visit(row_, std::span<const ColumnSpan>(spans_));
    for (int row = row_ + 1; row <= high_row; ++row) {
      spans_.clear();
      above_.AppendSpans(row - row_, x_, &spans_);
      visit(row, std::span<const ColumnSpan>(spans_));
    }
    for (int row = row_ - 1; row >= low_row; --row) {
      spans_.clear();
      below_.AppendSpans(row_ - row, x_, &spans_);
      visit(row, std::span<const ColumnSpan>(spans_));
    }
  }

 private:
  // The rays that leave the origin's row on one side. Step s is the s-th row from there.
  class Side {
   public:
    void Clear() { rays_.clear(); }
    void Add(double slope, int crossings, int end_column) { rays_.push_back({slope, crossings, end_column}); }

    // Orders the rays and finds where neighbours part. `first` is the distance from the origin to the first row border.
    void Arrange(double first, int num_steps);

    // The spans of one step; to be asked for in the order of steps.
    void AppendSpans(int step, double x, std::vector<ColumnSpan>* spans);

   private:
    struct Ray {
      double slope;   // columns per row outwards
      int crossings;  // of row borders: the step in which it ends
      int end_column;
    };

    void Sort();
    void AppendRuns(int step, double x, std::vector<ColumnSpan>* spans) const;

    double first_ = 0.0;
    std::vector<Ray> rays_;              // in order of slope
    std::vector<std::uint64_t> alive_;   // bit i: ray i crosses the whole row of this step
    std::vector<std::uint64_t> fused_;   // bit i: so does ray i + 1, and no whole cell lies between them
    RowLists<std::uint32_t> ending_;     // rays by the step in which they end
    RowLists<std::uint32_t> parting_;    // rays by the step from which the next one is too far away
  };

  double x_ = 0.0;
  double y_ = 0.0;
  int column_ = 0;  // of the origin
  int row_ = 0;
  double first_above_ = 0.0;  // to the border above the origin
  double first_below_ = 0.0;
  Side above_;
  Side below_;
  std::vector<ColumnSpan> spans_;
};

}  // namespace survey
