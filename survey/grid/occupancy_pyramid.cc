// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/occupancy_pyramid.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace survey {
namespace {

constexpr double kQuantum = 0.01;  // log-odds of one step of evidence
constexpr int kGrowthCells = 128;  // the array grows in steps of this many cells; a multiple of 2^(levels-1)

double LogOdds(double p) { return std::log(p / (1.0 - p)); }

// Evidence of a scan for one cell, and its bounds.
struct Steps {
  std::int16_t hit, miss, prior, highest;
};

// Cells that are updated together.
constexpr int kPack = 8;
using Pack [[gnu::vector_size(kPack * sizeof(std::int16_t))]] = std::int16_t;

// All bits of lane i set where bit i of the index is.
constexpr auto kMasks = [] {
  std::array<std::array<std::int16_t, kPack>, 256> masks{};
  for (std::size_t bits = 0; bits < masks.size(); ++bits) {
    for (std::size_t lane = 0; lane < kPack; ++lane)
      masks[bits][lane] = static_cast<std::int16_t>(-static_cast<int>((bits >> lane) & 1U));
  }
  return masks;
}();
Pack MaskOf(std::uint64_t bits) { return std::bit_cast<Pack>(kMasks[bits & 0xff]); }

Pack Load(const OccupancyPyramid::Evidence* cells) {
  Pack pack;
  std::memcpy(&pack, cells, sizeof(pack));
  return pack;
}

void Store(const Pack& pack, OccupancyPyramid::Evidence* cells) { std::memcpy(cells, &pack, sizeof(pack)); }

// Enters hits and misses in the cells of a pack, clamped to [1, highest].
void UpdatePack(const Pack& hit, const Pack& missed, const Steps& steps, OccupancyPyramid::Evidence* cells) {
  const Pack old = Load(cells);
  const Pack sum = old + ((old == 0) & steps.prior) + (hit & steps.hit) + (missed & steps.miss);
  const Pack not_below = sum > 1 ? sum : Pack{} + std::int16_t{1};
  const Pack clamped = not_below < steps.highest ? not_below : Pack{} + steps.highest;
  const Pack touched = hit | missed;
  Store((touched & clamped) | (~touched & old), cells);
}

// The same for a whole word of cells, of which all were missed.
void UpdateMissed(const Steps& steps, OccupancyPyramid::Evidence* cells) {
  for (int i = 0; i < CellBits::kColumns; i += kPack) {
    const Pack old = Load(cells + i);
    const Pack sum = old + ((old == 0) & steps.prior) + steps.miss;
    Store(sum > 1 ? sum : Pack{} + std::int16_t{1}, cells + i);
  }
}

// Each of n cells becomes the maximum of two cells in each of two rows.
void MaximaOfFour(const OccupancyPyramid::Evidence* lower, const OccupancyPyramid::Evidence* upper,
                  OccupancyPyramid::Evidence* parents, int n) {
  for (int i = 0; i < n; ++i) {
    const auto value = [](OccupancyPyramid::Evidence e) { return static_cast<std::int16_t>(e); };
    const std::int16_t left = std::max(value(lower[2 * i]), value(upper[2 * i]));
    const std::int16_t right = std::max(value(lower[2 * i + 1]), value(upper[2 * i + 1]));
    parents[i] = static_cast<OccupancyPyramid::Evidence>(std::max(left, right));
  }
}

int FloorTo(int value, int step) { return (value >= 0 ? value / step : -((-value + step - 1) / step)) * step; }

}  // namespace

OccupancyPyramid::OccupancyPyramid(const OccupancyOptions& options) : options_(options) {
  hit_step_ = static_cast<std::int16_t>(std::lround(LogOdds(options.p_hit) / kQuantum));
  miss_step_ = static_cast<std::int16_t>(std::lround(LogOdds(options.p_miss) / kQuantum));
  const int lowest = static_cast<int>(std::lround(LogOdds(options.p_min) / kQuantum));
  const int highest = static_cast<int>(std::lround(LogOdds(options.p_max) / kQuantum));
  prior_ = static_cast<std::int16_t>(1 - lowest);
  max_evidence_ = static_cast<std::int16_t>(1 + highest - lowest);
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
  for (const std::span<const Eigen::Vector2f> points : {hits, free_ends, surface}) {
    for (const Eigen::Vector2f& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  GrowToHold(low, high);
  const Level& base = levels_.front();
  const int low_row = static_cast<int>(base.RowOf(low.y()));
  const int high_row = static_cast<int>(base.RowOf(high.y()));
  const int low_column = static_cast<int>(base.ColumnOf(low.x()));
  const int high_column = static_cast<int>(base.ColumnOf(high.x()));
  touched_.assign(static_cast<std::size_t>(base.height), {});
  // A cell around, for the rounding of rays: GrowToHold has left two.
  missed_.Reset(low_row - 1, high_row + 1, low_column - 1, high_column + 1);
  hit_.Reset(low_row - 1, high_row + 1, low_column - 1, high_column + 1);
  fan_.Begin(base.ColumnOf(origin.x()), base.RowOf(origin.y()));
  const auto add = [&](std::span<const Eigen::Vector2f> points, bool have_rays, bool are_hits) {
    for (const Eigen::Vector2f& point : points) {
      const double x = base.ColumnOf(point.x());
      const double y = base.RowOf(point.y());
      const auto column = static_cast<int>(x);
      const auto row = static_cast<int>(y);
      if (have_rays) fan_.Add(x, y, column, row);
      if (are_hits) hit_.LineOf(row).Add(column);
    }
  };
  add(hits, true, true);
  add(free_ends, true, false);
  add(surface, false, true);
  fan_.Mark(&missed_);
  for (int row = low_row; row <= high_row; ++row) UpdateRow(row);
  UpdateCoarseLevels(low_row, high_row);
}

void OccupancyPyramid::UpdateRow(int row) {
  const std::span<const std::uint64_t> missed = missed_.Row(row);
  const std::span<const std::uint64_t> hit = hit_.Row(row);
  const Steps steps = {hit_step_, miss_step_, prior_, max_evidence_};
  ColumnSpan& touched = touched_[static_cast<std::size_t>(row)];
  Evidence* cells = levels_.front().RowBegin(row) + missed_.FirstColumn();
  for (std::size_t word = 0; word < missed.size(); ++word, cells += CellBits::kColumns) {
    const std::uint64_t hits = hit[word];
    const std::uint64_t misses = missed[word] & ~hits;
    if ((hits | misses) == 0) continue;
    const int column = missed_.FirstColumn() + static_cast<int>(word) * CellBits::kColumns;
    touched = {std::min(touched.first, column), column + CellBits::kColumns - 1};
    if (~misses == 0) {
      UpdateMissed(steps, cells);
      continue;
    }
    for (std::uint64_t left = hits | misses; left != 0;) {
      const int pack = std::countr_zero(left) / kPack * kPack;
      left &= ~(std::uint64_t{0xff} << pack);
      UpdatePack(MaskOf(hits >> pack), MaskOf(misses >> pack), steps, cells + pack);
    }
  }
}

void OccupancyPyramid::UpdateCoarseLevels(int low_row, int high_row) {
  // Whole cells of the coarsest level, so that each level looks at rows of the one below only.
  const int inner_rows = (1 << (levels_.size() - 1)) - 1;
  low_row &= ~inner_rows;
  high_row |= inner_rows;
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    Level& grid = levels_[level];
    Level& child = levels_[level - 1];
    low_row /= 2;
    high_row /= 2;
    for (int row = low_row; row <= high_row; ++row) {
      const ColumnSpan lower = touched_[static_cast<std::size_t>(2 * row)];
      const ColumnSpan upper = touched_[static_cast<std::size_t>(2 * row) + 1];
      ColumnSpan& touched = touched_[static_cast<std::size_t>(row)];
      touched = {std::min(lower.first, upper.first), std::max(lower.last, upper.last)};
      if (touched.empty()) continue;
      touched = {touched.first / 2, touched.last / 2};
      MaximaOfFour(child.RowBegin(2 * row) + 2 * touched.first, child.RowBegin(2 * row + 1) + 2 * touched.first,
                   grid.RowBegin(row) + touched.first, touched.last + 1 - touched.first);
    }
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
  // A side of a large array that must move moves by an eighth of its size, so that it is not copied every few metres.
  const auto margin = [](int size) { return FloorTo(size / 8, 2 * kGrowthCells); };
  const auto begin_of = [&](int low_cell, int begin, int size) {
    return empty || low_cell < begin ? FloorTo(low_cell - margin(size), kGrowthCells) : begin;
  };
  const auto end_of = [&](int high_cell, int begin, int size) {
    return empty || high_cell >= begin + size ? FloorTo(high_cell + margin(size) + kGrowthCells, kGrowthCells)
                                              : begin + size;
  };
  const int min_column = begin_of(low_column, base.min_column, base.width);
  const int min_row = begin_of(low_row, base.min_row, base.height);
  const int end_column = end_of(high_column, base.min_column, base.width);
  const int end_row = end_of(high_row, base.min_row, base.height);

  const auto moved = [](const std::vector<Evidence>& cells, const Level& from, const Level& to) {
    std::vector<Evidence> result(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height), kUnknown);
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
    grown.cells = moved(levels_[level].cells, levels_[level], grown);
    levels_[level] = std::move(grown);
  }
}

}  // namespace survey
