// SPDX-License-Identifier: Apache-2.0
//
// The cells that the rays of one scan cross, row by row: the same cells that line_cells.h visits ray by ray, each once.
//
// All rays start at one point, so within a row they lie in the order of their slopes. Neighbours that both cross the
// row and leave no whole cell between them fuse to a run, whose first and last ray alone bound the cells of all; where
// beams are dense the cost is that of the outline, not of the area. A ray that ends splits its run, so that nothing
// behind the nearer of two neighbouring end points is claimed. Rays only draw apart: one that has lost both neighbours
// is followed to its end by itself.
//
// Coordinates in cells; column and row numbers must not be negative.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "survey/grid/cell_bits.h"
#include "survey/grid/row_lists.h"

namespace survey {

class RayFan {
 public:
  // Forgets all rays. The new ones start at (x, y).
  void Begin(double x, double y);

  // A ray to (x, y), which lies in cell (column, row). That cell is not part of the ray.
  void Add(double x, double y, int column, int row);

  // Adds the cells that rays cross to a set, whose window must hold the origin, all ends and a cell around.
  void Mark(CellBits* crossed);

 private:
  // The rays that leave the origin's row on one side. Step s is the s-th row from there.
  class Side {
   public:
    void Clear() { rays_.clear(); }
    void Add(double slope, int crossings, int end_column) { rays_.push_back({slope, crossings, end_column}); }

    // Marks the cells of all rays. `x` is the origin's column, `first` the distance from it to the first row border;
    // step s is in row + s * direction.
    void Mark(double x, double first, int row, int direction, CellBits* crossed);

   private:
    struct Ray {
      double slope;   // columns per row outwards
      int crossings;  // of row borders: the step in which it ends
      int end_column;
    };

    void Sort();
    void Arrange();
    int FirstStepApart(std::size_t i) const;  // in which ray i and the next do not make one run any more
    int ColumnAt(const Ray& ray, int border) const;
    void FollowToEnd(const Ray& ray, int first_step);
    void MarkRuns(int step);
    static constexpr std::uint64_t Bit(std::size_t i) { return std::uint64_t{1} << (i % 64); }

    double x_ = 0.0;
    double first_ = 0.0;
    int row_ = 0;
    int direction_ = 1;
    CellBits* crossed_ = nullptr;
    int num_steps_ = 0;                 // with runs
    std::vector<Ray> rays_;             // in order of slope
    std::vector<std::uint64_t> alive_;  // bit i: ray i crosses the whole row of this step, in a run
    std::vector<std::uint64_t> fused_;  // bit i: so does ray i + 1, and no whole cell lies between them
    RowLists<std::uint32_t> leaving_;   // rays by the step from which they are in no run
    RowLists<std::uint32_t> parting_;   // rays by the step from which the next one is too far away
  };

  double x_ = 0.0;
  double y_ = 0.0;
  int column_ = 0;  // of the origin
  int row_ = 0;
  Side above_;
  Side below_;
  std::vector<int> in_origin_row_;  // end columns of rays that never leave it
};

}  // namespace survey
