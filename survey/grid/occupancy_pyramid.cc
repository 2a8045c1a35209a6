// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/occupancy_pyramid.h"

#include <algorithm>
#include <limits>

#include "survey/grid/line_cells.h"

namespace survey {
namespace {

constexpr double kQuantum = 0.01;  // log-odds of one step of evidence
constexpr int kGrowthCells = 128;  // the array grows in steps of this many cells; a multiple of 2^(levels-1)

double LogOdds(double p) { return std::log(p / (1.0 - p)); }

int FloorTo(int value, int step) { return (value >= 0 ? value / step : -((-value + step - 1) / step)) * step; }

}  // namespace

OccupancyPyramid::OccupancyPyramid(const OccupancyOptions& options) : options_(options) {
  hit_step_ = static_cast<int>(std::lround(LogOdds(options.p_hit) / kQuantum));
  miss_step_ = static_cast<int>(std::lround(LogOdds(options.p_miss) / kQuantum));
  const int lowest = static_cast<int>(std::lround(LogOdds(options.p_min) / kQuantum));
  const int highest = static_cast<int>(std::lround(LogOdds(options.p_max) / kQuantum));
  prior_ = 1 - lowest;
  max_evidence_ = 1 + highest - lowest;
  occupancy_of_.resize(static_cast<std::size_t>(max_evidence_) + 1);
  occupancy_of_[kUnknown] = static_cast<float>(options.p_min);
  for (int e = 1; e <= max_evidence_; ++e) {
    const double log_odds = (e - 1 + lowest) * kQuantum;
    occupancy_of_[static_cast<std::size_t>(e)] = static_cast<float>(1.0 / (1.0 + std::exp(-log_odds)));
  }
  levels_.resize(static_cast<std::size_t>(options.num_levels));
  for (int level = 0; level < options.num_levels; ++level) {
    levels_[static_cast<std::size_t>(level)].cells_per_m = static_cast<float>(1.0 / cell_size_m(level));
  }
}

float OccupancyPyramid::LogOddsOf(Evidence evidence) const {
  if (evidence == kUnknown) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>((static_cast<int>(evidence) - prior_) * kQuantum);
}

void OccupancyPyramid::Insert(const Eigen::Vector2f& origin, std::span<const Eigen::Vector2f> hits,
                              std::span<const Eigen::Vector2f> free_ends, std::span<const Eigen::Vector2f> surface) {
  Eigen::Vector2f low = origin;
  Eigen::Vector2f high = origin;
  for (const std::span<const Eigen::Vector2f> ends : {hits, free_ends}) {
    for (const Eigen::Vector2f& end : ends) {
      low = low.cwiseMin(end);
      high = high.cwiseMax(end);
    }
  }
  GrowToHold(low, high);
  if (++scan_number_ == 0) {  // wrapped around: forget which cells old scans touched
    std::fill(touched_.begin(), touched_.end(), std::uint16_t{0});
    scan_number_ = 1;
  }
  DrawHits(hits);
  DrawHits(surface);
  for (const Eigen::Vector2f& hit : hits) TraceMisses(origin, hit);
  for (const Eigen::Vector2f& end : free_ends) TraceMisses(origin, end);
}

void OccupancyPyramid::DrawHits(std::span<const Eigen::Vector2f> hits) {
  const float cells_per_m = levels_.front().cells_per_m;
  for (const Eigen::Vector2f& hit : hits) {
    Update(static_cast<int>(std::floor(hit.x() * cells_per_m)), static_cast<int>(std::floor(hit.y() * cells_per_m)),
           true);
  }
}

void OccupancyPyramid::TraceMisses(const Eigen::Vector2f& origin, const Eigen::Vector2f& end) {
  const float cells_per_m = levels_.front().cells_per_m;
  ForEachCellOnLine(origin * cells_per_m, end * cells_per_m,
                    [this](int column, int row) { Update(column, row, false); });
}

void OccupancyPyramid::Update(int column, int row, bool hit) {
  Level& grid = levels_.front();
  const std::size_t index = static_cast<std::size_t>(row - grid.min_row) * static_cast<std::size_t>(grid.width) +
                            static_cast<std::size_t>(column - grid.min_column);
  if (touched_[index] == scan_number_) return;
  touched_[index] = scan_number_;
  Evidence& evidence = grid.cells[index];
  const Evidence old = evidence;
  const int from = old == kUnknown ? prior_ : old;
  evidence = static_cast<Evidence>(std::clamp(from + (hit ? hit_step_ : miss_step_), 1, max_evidence_));
  if (evidence > old) {
    RaiseParents(column, row, evidence);
  } else if (evidence < old) {
    RecomputeParents(column, row, old);
  }
}

void OccupancyPyramid::RaiseParents(int column, int row, Evidence evidence) {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    Level& grid = levels_[level];
    Evidence& parent =
        grid.cells[static_cast<std::size_t>((row >> level) - grid.min_row) * static_cast<std::size_t>(grid.width) +
                   static_cast<std::size_t>((column >> level) - grid.min_column)];
    if (parent >= evidence) return;
    parent = evidence;
  }
}

void OccupancyPyramid::RecomputeParents(int column, int row, Evidence old_evidence) {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    const Level& child = levels_[level - 1];
    Level& grid = levels_[level];
    const int parent_column = (column >> level) - grid.min_column;
    const int parent_row = (row >> level) - grid.min_row;
    Evidence& parent = grid.cells[static_cast<std::size_t>(parent_row) * static_cast<std::size_t>(grid.width) +
                                  static_cast<std::size_t>(parent_column)];
    if (parent != old_evidence) return;  // another child holds the maximum
    const Evidence* lower =
        &child.cells[static_cast<std::size_t>(2 * parent_row) * static_cast<std::size_t>(child.width) +
                     static_cast<std::size_t>(2 * parent_column)];
    const Evidence* upper = lower + child.width;
    const Evidence highest = std::max(std::max(lower[0], lower[1]), std::max(upper[0], upper[1]));
    if (highest == parent) return;
    parent = highest;
  }
}

void OccupancyPyramid::GrowToHold(const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
  const Level& base = levels_.front();
  const int low_column = static_cast<int>(std::floor(low.x() * base.cells_per_m)) - 2;
  const int low_row = static_cast<int>(std::floor(low.y() * base.cells_per_m)) - 2;
  const int high_column = static_cast<int>(std::floor(high.x() * base.cells_per_m)) + 2;
  const int high_row = static_cast<int>(std::floor(high.y() * base.cells_per_m)) + 2;
  const bool empty = base.width == 0;
  if (!empty && low_column >= base.min_column && low_row >= base.min_row &&
      high_column < base.min_column + base.width && high_row < base.min_row + base.height) {
    return;
  }
  const int min_column = FloorTo(empty ? low_column : std::min(low_column, base.min_column), kGrowthCells);
  const int min_row = FloorTo(empty ? low_row : std::min(low_row, base.min_row), kGrowthCells);
  const int end_column = FloorTo(
      (empty ? high_column : std::max(high_column, base.min_column + base.width - 1)) + kGrowthCells, kGrowthCells);
  const int end_row =
      FloorTo((empty ? high_row : std::max(high_row, base.min_row + base.height - 1)) + kGrowthCells, kGrowthCells);

  const auto moved = [](const auto& cells, const Level& from, const Level& to) {
    std::remove_cvref_t<decltype(cells)> result(
        static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height), 0);
    for (int row = 0; row < from.height; ++row) {
      const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(row) * from.width;
      std::copy(begin, begin + from.width,
                result.begin() + static_cast<std::ptrdiff_t>(row + from.min_row - to.min_row) * to.width +
                    (from.min_column - to.min_column));
    }
    return result;
  };
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    Level grown{.cells_per_m = levels_[level].cells_per_m,
                .min_column = min_column >> level,
                .min_row = min_row >> level,
                .width = (end_column - min_column) >> level,
                .height = (end_row - min_row) >> level};
    if (level == 0) touched_ = moved(touched_, levels_[level], grown);
    grown.cells = moved(levels_[level].cells, levels_[level], grown);
    levels_[level] = std::move(grown);
  }
}

}  // namespace survey
