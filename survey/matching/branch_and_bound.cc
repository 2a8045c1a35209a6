// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/branch_and_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace survey {
namespace {

using Cell = Eigen::Vector2i;

constexpr float kFarthestForStep_m = 12.0F;

// The scan turned by one angle of the window, in cells of the map at the window's centre.
struct TurnedScan {
  double angle_rad = 0.0;  // relative to the centre
  std::vector<Cell> cells;
};

struct Candidate {
  int scan = 0;  // index of the turned scan
  int shift_x = 0;
  int shift_y = 0;
  int score = 0;  // sum of the grid's values: an upper bound on coarse levels
};

struct SearchGrid {
  std::vector<TurnedScan> scans;
  int half_shift = 0;
  int min_sum = 0;  // sum of values that a result must exceed
};

SearchGrid PrepareSearch(const SlidingMaximumGrids& grids, std::span<const Eigen::Vector2f> points_in_scan,
                         const Pose2& centre, const SearchWindow& window) {
  float farthest = static_cast<float>(grids.cell_size_m());
  for (const Eigen::Vector2f& p : points_in_scan) farthest = std::max(farthest, p.norm());
  // Few points lie that far: beyond, a step may move them by more than a cell, which the refinement makes good.
  farthest = std::min(farthest, kFarthestForStep_m);
  const double ratio = grids.cell_size_m() / static_cast<double>(farthest);
  const double step = std::acos(1.0 - 0.5 * std::min(1.0, ratio * ratio));  // [Hess16] eq. (7)
  const int half_steps = static_cast<int>(std::ceil(window.half_angle_rad / step));

  SearchGrid search;
  search.half_shift = static_cast<int>(std::ceil(window.half_width_m / grids.cell_size_m()));
  const double n = static_cast<double>(points_in_scan.size());
  const double min_value = (window.min_score - static_cast<double>(grids.OccupancyOf(0))) /
                           static_cast<double>(grids.OccupancyOf(1) - grids.OccupancyOf(0));
  search.min_sum = static_cast<int>(std::floor(std::max(min_value, 0.0) * n));
  const auto cells_per_m = static_cast<float>(1.0 / grids.cell_size_m());
  for (int k = -half_steps; k <= half_steps; ++k) {
    TurnedScan scan{.angle_rad = k * step};
    const auto c = static_cast<float>(std::cos(centre.theta + scan.angle_rad));
    const auto s = static_cast<float>(std::sin(centre.theta + scan.angle_rad));
    scan.cells.reserve(points_in_scan.size());
    for (const Eigen::Vector2f& p : points_in_scan) {
      scan.cells.emplace_back(
          static_cast<int>(std::floor((c * p.x() - s * p.y() + static_cast<float>(centre.x)) * cells_per_m)),
          static_cast<int>(std::floor((s * p.x() + c * p.y() + static_cast<float>(centre.y)) * cells_per_m)));
    }
    search.scans.push_back(std::move(scan));
  }
  return search;
}

int SumOfValues(const SlidingMaximumGrids& grids, int level, const TurnedScan& scan, int shift_x, int shift_y) {
  int sum = 0;
  for (const Cell& cell : scan.cells) sum += grids.At(level, cell.x() + shift_x, cell.y() + shift_y);
  return sum;
}

bool Better(const Candidate& a, const Candidate& b) { return a.score > b.score; }

// Depth first: the best child before the others, so that the bound rises early.
void Branch(const SlidingMaximumGrids& grids, const SearchGrid& search, int level,
            std::span<const Candidate> candidates, Candidate* best) {
  for (const Candidate& candidate : candidates) {
    if (candidate.score <= best->score) return;  // sorted: nothing better follows
    if (level == 0) {
      *best = candidate;
      return;
    }
    std::array<Candidate, 4> children;
    std::size_t count = 0;
    const int half = 1 << (level - 1);
    for (const int dx : {0, half}) {
      for (const int dy : {0, half}) {
        const int x = candidate.shift_x + dx;
        const int y = candidate.shift_y + dy;
        if (x > search.half_shift || y > search.half_shift) continue;
        children[count++] = {
            candidate.scan, x, y,
            SumOfValues(grids, level - 1, search.scans[static_cast<std::size_t>(candidate.scan)], x, y)};
      }
    }
    std::stable_sort(children.begin(), children.begin() + static_cast<std::ptrdiff_t>(count), Better);
    Branch(grids, search, level - 1, {children.data(), count}, best);
  }
}

std::vector<Candidate> CandidatesOfLevel(const SlidingMaximumGrids& grids, const SearchGrid& search, int level) {
  std::vector<Candidate> candidates;
  const int step = 1 << level;
  for (std::size_t k = 0; k < search.scans.size(); ++k) {
    for (int x = -search.half_shift; x <= search.half_shift; x += step) {
      for (int y = -search.half_shift; y <= search.half_shift; y += step) {
        candidates.push_back({static_cast<int>(k), x, y, SumOfValues(grids, level, search.scans[k], x, y)});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), Better);
  return candidates;
}

std::optional<SearchResult> Finish(const SlidingMaximumGrids& grids, const SearchGrid& search, const Pose2& centre,
                                   const Candidate& best) {
  if (best.scan < 0) return std::nullopt;
  const TurnedScan& scan = search.scans[static_cast<std::size_t>(best.scan)];
  SearchResult result;
  result.map_from_scan = {centre.x + best.shift_x * grids.cell_size_m(), centre.y + best.shift_y * grids.cell_size_m(),
                          NormalizeAngle(centre.theta + scan.angle_rad)};
  const double mean = static_cast<double>(best.score) / static_cast<double>(scan.cells.size());
  result.score = static_cast<double>(grids.OccupancyOf(0)) +
                 mean * static_cast<double>(grids.OccupancyOf(1) - grids.OccupancyOf(0));
  return result;
}

}  // namespace

SlidingMaximumGrids::SlidingMaximumGrids(const OccupancyPyramid& pyramid, int pyramid_level, int num_levels)
    : cell_size_m_(pyramid.cell_size_m(pyramid_level)) {
  const OccupancyPyramid::Extent extent = pyramid.ExtentOf(pyramid_level);
  Level base{extent.min_column, extent.min_row, extent.width, extent.height, {}};
  OccupancyPyramid::Evidence highest = 1;
  for (int row = 0; row < extent.height; ++row) {
    for (int column = 0; column < extent.width; ++column) {
      highest = std::max(highest, pyramid.At(pyramid_level, extent.min_column + column, extent.min_row + row));
    }
  }
  low_ = pyramid.OccupancyOf(OccupancyPyramid::kUnknown);
  const float high = pyramid.OccupancyOf(highest);
  step_ = std::max(high - low_, 1e-3F) / 255.0F;
  std::vector<std::uint8_t> value_of(static_cast<std::size_t>(highest) + 1);
  for (std::size_t e = 0; e < value_of.size(); ++e) {
    value_of[e] = static_cast<std::uint8_t>(std::clamp(
        (pyramid.OccupancyOf(static_cast<OccupancyPyramid::Evidence>(e)) - low_) / step_ + 0.5F, 0.0F, 255.0F));
  }
  base.cells.resize(static_cast<std::size_t>(base.width) * static_cast<std::size_t>(base.height));
  std::size_t index = 0;
  for (int row = 0; row < extent.height; ++row) {
    for (int column = 0; column < extent.width; ++column) {
      base.cells[index++] = value_of[pyramid.At(pyramid_level, extent.min_column + column, extent.min_row + row)];
    }
  }
  levels_.push_back(std::move(base));
  for (int level = 1; level < num_levels; ++level) levels_.push_back(Widened(levels_.back(), 1 << (level - 1)));
}

// Maximum of each cell and those `shift` further along x, y and both: doubles the block that a cell stands for. Blocks
// may start `shift` cells before the array.
SlidingMaximumGrids::Level SlidingMaximumGrids::Widened(const Level& level, int shift) {
  Level wide{level.min_column - shift, level.min_row - shift, level.width + shift, level.height + shift, {}};
  const auto width = static_cast<std::size_t>(wide.width);
  std::vector<std::uint8_t> along_x(width * static_cast<std::size_t>(level.height));
  for (int row = 0; row < level.height; ++row) {
    const std::uint8_t* from = &level.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width)];
    std::uint8_t* to = &along_x[static_cast<std::size_t>(row) * width];
    for (int column = 0; column < level.width; ++column) to[column] = from[column];  // the cell `shift` to the right
    for (int column = 0; column < level.width; ++column)
      to[column + shift] = std::max(to[column + shift], from[column]);
  }
  wide.cells.assign(width * static_cast<std::size_t>(wide.height), 0);
  for (int row = 0; row < level.height; ++row) {
    const std::uint8_t* from = &along_x[static_cast<std::size_t>(row) * width];
    std::uint8_t* upper = &wide.cells[static_cast<std::size_t>(row + shift) * width];
    std::uint8_t* lower = &wide.cells[static_cast<std::size_t>(row) * width];
    for (std::size_t column = 0; column < width; ++column) {
      upper[column] = std::max(upper[column], from[column]);
      lower[column] = std::max(lower[column], from[column]);
    }
  }
  return wide;
}

std::optional<SearchResult> BranchAndBound(const SlidingMaximumGrids& grids,
                                           std::span<const Eigen::Vector2f> points_in_scan, const Pose2& centre,
                                           const SearchWindow& window) {
  if (points_in_scan.empty()) return std::nullopt;
  const SearchGrid search = PrepareSearch(grids, points_in_scan, centre, window);
  int level = grids.num_levels() - 1;
  while (level > 0 && (1 << level) > search.half_shift) --level;
  Candidate best{.scan = -1, .score = search.min_sum};
  const std::vector<Candidate> candidates = CandidatesOfLevel(grids, search, level);
  Branch(grids, search, level, candidates, &best);
  return Finish(grids, search, centre, best);
}

std::optional<SearchResult> ExhaustiveSearch(const SlidingMaximumGrids& grids,
                                             std::span<const Eigen::Vector2f> points_in_scan, const Pose2& centre,
                                             const SearchWindow& window) {
  if (points_in_scan.empty()) return std::nullopt;
  const SearchGrid search = PrepareSearch(grids, points_in_scan, centre, window);
  Candidate best{.scan = -1, .score = search.min_sum};
  for (const Candidate& candidate : CandidatesOfLevel(grids, search, 0)) {
    if (candidate.score > best.score) best = candidate;
  }
  return Finish(grids, search, centre, best);
}

}  // namespace survey
