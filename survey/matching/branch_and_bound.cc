// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/branch_and_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace survey {
namespace {

constexpr float kFarthestForStep_m = 12.0F;

// The scan turned by one angle of the window: places of its points in the grids, at the window's centre. Points that no
// shift brings onto the map are left out; they add nothing.
struct TurnedScan {
  double angle_rad = 0.0;  // relative to the centre
  std::vector<int> places;
};

struct Candidate {
  int scan = 0;  // index of the turned scan
  int shift_x = 0;
  int shift_y = 0;
  int score = 0;  // sum of the grid's values: an upper bound on coarse levels
};

struct SearchGrid {
  std::vector<TurnedScan> scans;
  int num_points = 0;
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
  search.num_points = static_cast<int>(points_in_scan.size());
  search.half_shift =
      std::min(static_cast<int>(std::ceil(window.half_width_m / grids.cell_size_m())), grids.max_shift());
  const double min_value = (window.min_score - static_cast<double>(grids.OccupancyOf(0))) /
                           static_cast<double>(grids.OccupancyOf(1) - grids.OccupancyOf(0));
  search.min_sum = static_cast<int>(std::floor(std::max(min_value, 0.0) * search.num_points));
  const auto cells_per_m = static_cast<float>(1.0 / grids.cell_size_m());
  for (int k = -half_steps; k <= half_steps; ++k) {
    TurnedScan scan{.angle_rad = k * step, .places = {}};
    const auto c = static_cast<float>(std::cos(centre.theta + scan.angle_rad));
    const auto s = static_cast<float>(std::sin(centre.theta + scan.angle_rad));
    scan.places.reserve(points_in_scan.size());
    for (const Eigen::Vector2f& p : points_in_scan) {
      const auto column =
          static_cast<int>(std::floor((c * p.x() - s * p.y() + static_cast<float>(centre.x)) * cells_per_m));
      const auto row =
          static_cast<int>(std::floor((s * p.x() + c * p.y() + static_cast<float>(centre.y)) * cells_per_m));
      if (grids.InReach(column, row)) scan.places.push_back(grids.IndexOf(column, row));
    }
    // Even if all that is left fell on the best cells it would not do.
    if (255 * static_cast<int>(scan.places.size()) > search.min_sum) search.scans.push_back(std::move(scan));
  }
  return search;
}

int SumOfValues(const std::uint8_t* values, const TurnedScan& scan, int offset) {
  int sum = 0;
  for (const int place : scan.places) sum += values[place + offset];
  return sum;
}

// Sums for the shift that `offset` stands for, and for `half` more along x, y and both.
std::array<int, 4> SumsOfFour(const std::uint8_t* values, const TurnedScan& scan, int offset, int half, int half_rows) {
  int a = 0;
  int b = 0;
  int c = 0;
  int d = 0;
  for (const int place : scan.places) {
    const std::uint8_t* value = values + (place + offset);
    a += value[0];
    b += value[half];
    c += value[half_rows];
    d += value[half_rows + half];
  }
  return {a, b, c, d};
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
    const int half = 1 << (level - 1);
    const std::array<int, 4> sums =
        SumsOfFour(grids.Values(level - 1), search.scans[static_cast<std::size_t>(candidate.scan)],
                   grids.OffsetOf(candidate.shift_x, candidate.shift_y), half, grids.OffsetOf(0, half));
    std::array<Candidate, 4> children;
    std::size_t count = 0;
    for (int child = 0; child < 4; ++child) {
      const int x = candidate.shift_x + (child % 2) * half;
      const int y = candidate.shift_y + (child / 2) * half;
      const int sum = sums[static_cast<std::size_t>(child)];
      if (x > search.half_shift || y > search.half_shift || sum <= best->score) continue;
      std::size_t place = count++;  // sorted in, ties behind
      for (; place > 0 && children[place - 1].score < sum; --place) children[place] = children[place - 1];
      children[place] = {candidate.scan, x, y, sum};
    }
    Branch(grids, search, level - 1, {children.data(), count}, best);
  }
}

std::vector<Candidate> CandidatesOfLevel(const SlidingMaximumGrids& grids, const SearchGrid& search, int level) {
  std::vector<Candidate> candidates;
  const int step = 1 << level;
  for (std::size_t k = 0; k < search.scans.size(); ++k) {
    for (int x = -search.half_shift; x <= search.half_shift; x += step) {
      for (int y = -search.half_shift; y <= search.half_shift; y += step) {
        const int sum = SumOfValues(grids.Values(level), search.scans[k], grids.OffsetOf(x, y));
        if (sum > search.min_sum) candidates.push_back({static_cast<int>(k), x, y, sum});
      }
    }
  }
  return candidates;
}

std::optional<SearchResult> Finish(const SlidingMaximumGrids& grids, const SearchGrid& search, const Pose2& centre,
                                   const Candidate& best) {
  if (best.scan < 0) return std::nullopt;
  const TurnedScan& scan = search.scans[static_cast<std::size_t>(best.scan)];
  SearchResult result;
  result.map_from_scan = {centre.x + best.shift_x * grids.cell_size_m(), centre.y + best.shift_y * grids.cell_size_m(),
                          NormalizeAngle(centre.theta + scan.angle_rad)};
  const double mean = static_cast<double>(best.score) / search.num_points;
  result.score = static_cast<double>(grids.OccupancyOf(0)) +
                 mean * static_cast<double>(grids.OccupancyOf(1) - grids.OccupancyOf(0));
  return result;
}

}  // namespace

SlidingMaximumGrids::SlidingMaximumGrids(const OccupancyPyramid& pyramid, int pyramid_level, int num_levels,
                                         double max_half_width_m)
    : cell_size_m_(pyramid.cell_size_m(pyramid_level)),
      max_shift_(static_cast<int>(std::ceil(max_half_width_m / pyramid.cell_size_m(pyramid_level)))) {
  const OccupancyPyramid::Extent extent = pyramid.ExtentOf(pyramid_level);
  min_column_ = extent.min_column - max_shift_;
  min_row_ = extent.min_row - max_shift_;
  width_ = extent.width + 4 * max_shift_;
  height_ = extent.height + 4 * max_shift_;
  const auto for_each_cell = [&](const auto& visit) {
    for (int row = extent.min_row; row < extent.min_row + extent.height; ++row) {
      for (int column = extent.min_column; column < extent.min_column + extent.width; ++column)
        visit(column, row, pyramid.At(pyramid_level, column, row));
    }
  };
  OccupancyPyramid::Evidence highest = 1;
  for_each_cell([&](int, int, OccupancyPyramid::Evidence evidence) { highest = std::max(highest, evidence); });
  low_ = pyramid.OccupancyOf(OccupancyPyramid::kUnknown);
  const float high = pyramid.OccupancyOf(highest);
  step_ = std::max(high - low_, 1e-3F) / 255.0F;
  std::vector<std::uint8_t> value_of(static_cast<std::size_t>(highest) + 1);
  for (std::size_t e = 0; e < value_of.size(); ++e) {
    value_of[e] = static_cast<std::uint8_t>(std::clamp(
        (pyramid.OccupancyOf(static_cast<OccupancyPyramid::Evidence>(e)) - low_) / step_ + 0.5F, 0.0F, 255.0F));
  }
  // Below lie rows that are read for shifts beyond the window, which do not count.
  levels_.emplace_back(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_ + max_shift_ + 1),
                       std::uint8_t{0});
  for_each_cell([&](int column, int row, OccupancyPyramid::Evidence evidence) {
    levels_.front()[static_cast<std::size_t>(IndexOf(column, row))] = value_of[evidence];
  });
  for (int level = 1; level < num_levels && (1 << level) <= std::max(max_shift_, 1); ++level)
    levels_.push_back(Widened(levels_.back(), 1 << (level - 1)));
}

// Maximum of each cell and those `shift` further along x, y and both: doubles the block that a cell stands for. What
// lies beyond the array was never observed.
std::vector<std::uint8_t> SlidingMaximumGrids::Widened(const std::vector<std::uint8_t>& level, int shift) const {
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  const auto step = static_cast<std::size_t>(shift);
  std::vector<std::uint8_t> wide = level;
  for (std::size_t row = 0; row < height; ++row) {
    std::uint8_t* cells = &wide[row * width];
    for (std::size_t column = 0; column + step < width; ++column)  // reads what is not written yet
      cells[column] = std::max(cells[column], cells[column + step]);
  }
  for (std::size_t row = 0; row + step < height; ++row) {
    std::uint8_t* cells = &wide[row * width];
    const std::uint8_t* further = cells + step * width;
    for (std::size_t column = 0; column < width; ++column) cells[column] = std::max(cells[column], further[column]);
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
  std::vector<Candidate> candidates = CandidatesOfLevel(grids, search, level);
  std::stable_sort(candidates.begin(), candidates.end(), Better);
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
