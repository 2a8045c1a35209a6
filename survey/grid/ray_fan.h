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

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "survey/grid/row_lists.h"

namespace survey {

// Columns first ... last, both included; without arguments none.
struct ColumnSpan {
  int first = std::numeric_limits<int>::max();
  int last = -1;

  bool empty() const { return last < first; }
};

inline ColumnSpan Hull(const ColumnSpan& a, const ColumnSpan& b) {
  return {std::min(a.first, b.first), std::max(a.last, b.last)};
}

// Columns of a ray in its last row: from the one that it enters by to the one before its end.
inline ColumnSpan UpToEnd(int column, int end_column) {
  return end_column > column ? ColumnSpan{column, end_column - 1} : ColumnSpan{end_column + 1, column};
}

class RayFan {
 public:
  // Forgets all rays. The new ones start at (x, y).
  void Begin(double x, double y);

  // A ray to (x, y), which lies in cell (column, row). That cell is not part of the ray.
  void Add(double x, double y, int column, int row);

  // Row by row from low_row to high_row, outwards from the origin's row on each side: calls mark(first, last) for
  // columns that rays cross, both included, some perhaps more than once, and then end_row(row, span of all these
  // columns). All rays must lie in these rows.
  template <typename Mark, typename EndRow>
  void ForEachRow(int low_row, int high_row, const Mark& mark, const EndRow& end_row) {
    above_.Arrange(first_above_, high_row - row_);
    below_.Arrange(first_below_, row_ - low_row);
    ColumnSpan crossed;
    for (const ColumnSpan& span : in_origin_row_) {
      mark(span.first, span.last);
      crossed = Hull(crossed, span);
    }
    crossed = Hull(crossed, Hull(above_.MarkStep(0, x_, mark), below_.MarkStep(0, x_, mark)));
    end_row(row_, crossed);
    for (int row = row_ + 1; row <= high_row; ++row) end_row(row, above_.MarkStep(row - row_, x_, mark));
    for (int row = row_ - 1; row >= low_row; --row) end_row(row, below_.MarkStep(row_ - row, x_, mark));
  }

 private:
  // The rays that leave the origin's row on one side. Step s is the s-th row from there.
  class Side {
   public:
    void Clear() { rays_.clear(); }
    void Add(double slope, int crossings, int end_column) { rays_.push_back({slope, crossings, end_column}); }

    // Orders the rays and finds where neighbours part. `first` is the distance from the origin to the first row border.
    void Arrange(double first, int num_steps);

    // Marks the cells of one step and returns their span; to be called in the order of steps. `x` is the origin's.
    template <typename Mark>
    ColumnSpan MarkStep(int step, double x, const Mark& mark) {
      const double inner = first_ + step - 1;
      ColumnSpan crossed;
      ending_.ForEach(step, [&](std::uint32_t i) {
        End(i);
        const int column = static_cast<int>(x + inner * rays_[i].slope);
        if (column == rays_[i].end_column) return;
        const ColumnSpan span = UpToEnd(column, rays_[i].end_column);
        mark(span.first, span.last);
        crossed = Hull(crossed, span);
      });
      parting_.ForEach(step, [&](std::uint32_t i) { fused_[i / 64] &= ~Bit(i); });
      // Step 0 begins at the origin itself.
      return Hull(crossed, MarkRuns(std::max(inner, 0.0), first_ + step, x, mark));
    }

   private:
    struct Ray {
      double slope;   // columns per row outwards
      int crossings;  // of row borders: the step in which it ends
      int end_column;
    };

    void Sort();

    static constexpr std::uint64_t Bit(std::size_t i) { return std::uint64_t{1} << (i % 64); }

    // Ray i crosses no further row.
    void End(std::size_t i) {
      alive_[i / 64] &= ~Bit(i);
      fused_[i / 64] &= ~Bit(i);
      if (i > 0) fused_[(i - 1) / 64] &= ~Bit(i - 1);
    }

    // `inner` and `outer` are the distances of the borders of the row.
    template <typename Mark>
    ColumnSpan MarkRuns(double inner, double outer, double x, const Mark& mark) const {
      const auto lowest_column = [&](std::size_t i) {
        const double slope = rays_[i].slope;
        return static_cast<int>(x + (slope < 0.0 ? outer : inner) * slope);
      };
      const auto highest_column = [&](std::size_t i) {
        const double slope = rays_[i].slope;
        return static_cast<int>(x + (slope < 0.0 ? inner : outer) * slope);
      };
      ColumnSpan crossed;
      bool in_run = false;  // one that began in an earlier word
      int first_column = 0;
      std::uint64_t fused_before = 0;  // of the last ray of the word before, as bit 0
      for (std::size_t word = 0; word < alive_.size(); ++word) {
        const std::uint64_t alive = alive_[word];
        const std::uint64_t fused = fused_[word];
        std::uint64_t begins = alive & ~((fused << 1) | fused_before);
        std::uint64_t ends = alive & ~fused;
        fused_before = fused >> 63;
        const auto take_begin = [&] {
          first_column = lowest_column(64 * word + static_cast<std::size_t>(std::countr_zero(begins)));
          begins &= begins - 1;
        };
        for (; ends != 0; ends &= ends - 1) {
          if (!in_run) take_begin();
          in_run = false;
          const int last_column = highest_column(64 * word + static_cast<std::size_t>(std::countr_zero(ends)));
          mark(first_column, last_column);
          crossed = Hull(crossed, {first_column, last_column});
        }
        if (begins != 0) {
          take_begin();
          in_run = true;
        }
      }
      return crossed;
    }

    double first_ = 0.0;
    std::vector<Ray> rays_;             // in order of slope
    std::vector<std::uint64_t> alive_;  // bit i: ray i crosses the whole row of this step
    std::vector<std::uint64_t> fused_;  // bit i: so does ray i + 1, and no whole cell lies between them
    RowLists<std::uint32_t> ending_;    // rays by the step in which they end
    RowLists<std::uint32_t> parting_;   // rays by the step from which the next one is too far away
  };

  double x_ = 0.0;
  double y_ = 0.0;
  int column_ = 0;  // of the origin
  int row_ = 0;
  double first_above_ = 0.0;  // to the border above the origin
  double first_below_ = 0.0;
  Side above_;
  Side below_;
  std::vector<ColumnSpan> in_origin_row_;  // of rays that never leave it
};

}  // namespace survey
