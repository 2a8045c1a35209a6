// SPDX-License-Identifier: Apache-2.0
//
// Cells that a line segment crosses, by stepping from cell border to cell border (J. Amanatides, A. Woo: A fast voxel
// traversal algorithm for ray tracing, Eurographics 1987). Coordinates in cells.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace survey {

// Calls visit(column, row) for every cell on the segment except the one that holds `end`, from `begin` on.
template <typename Visit>
void ForEachCellOnLine(const Eigen::Vector2f& begin, const Eigen::Vector2f& end, const Visit& visit) {
  int column = static_cast<int>(std::floor(begin.x()));
  int row = static_cast<int>(std::floor(begin.y()));
  const int end_column = static_cast<int>(std::floor(end.x()));
  const int end_row = static_cast<int>(std::floor(end.y()));
  const float dx = end.x() - begin.x();
  const float dy = end.y() - begin.y();
  const int step_column = dx > 0 ? 1 : -1;
  const int step_row = dy > 0 ? 1 : -1;
  constexpr float kNever = std::numeric_limits<float>::max();
  const float per_column = dx != 0 ? std::abs(1 / dx) : kNever;
  const float per_row = dy != 0 ? std::abs(1 / dy) : kNever;
  float next_column = dx != 0 ? (static_cast<float>(column + (step_column > 0 ? 1 : 0)) - begin.x()) / dx : kNever;
  float next_row = dy != 0 ? (static_cast<float>(row + (step_row > 0 ? 1 : 0)) - begin.y()) / dy : kNever;
  // The number of steps is known, so that rounding can never run past the end.
  for (int left = std::abs(end_column - column) + std::abs(end_row - row); left > 0; --left) {
    visit(column, row);
    if ((next_column < next_row && column != end_column) || row == end_row) {
      column += step_column;
      next_column += per_column;
    } else {
      row += step_row;
      next_row += per_row;
    }
  }
}

}  // namespace survey
