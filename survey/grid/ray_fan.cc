// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/ray_fan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace survey {
namespace {

constexpr std::uint64_t Bit(std::size_t i) { return std::uint64_t{1} << (i % 64); }

// Columns from the one that the ray enters by to the one before its end.
ColumnSpan UpToEnd(int column, int end_column) {
  return end_column > column ? ColumnSpan{column, end_column - 1} : ColumnSpan{end_column + 1, column};
}

// Distance outwards, from the inner border of a row, up to which no whole cell fits between two rays with slopes
// a <= b. One leaves the row where it crosses the outer border, the other enters it at the inner one.
double FusedReach(double a, double b) {
  constexpr double kSafe = 1.0 - 1e-9;  // rounding must not fuse what has parted
  return kSafe * (1.0 + std::max(a, 0.0) + std::max(-b, 0.0)) / (b - a);
}

}  // namespace

void RayFan::Begin(double x, double y) {
  x_ = x;
  y_ = y;
  column_ = static_cast<int>(x);
  row_ = static_cast<int>(y);
  first_below_ = y - row_;
  first_above_ = 1.0 - first_below_;
  above_.Clear();
  below_.Clear();
  spans_.clear();
}

void RayFan::Add(double x, double y, int column, int row) {
  if (row > row_) {
    above_.Add((x - x_) / (y - y_), row - row_, column);
  } else if (row < row_) {
    below_.Add((x - x_) / (y_ - y), row_ - row, column);
  } else if (column != column_) {
    spans_.push_back(UpToEnd(column_, column));
  }
}

void RayFan::Side::Sort() {
  const auto by_slope = [](const Ray& a, const Ray& b) { return a.slope < b.slope; };
  const auto end = rays_.end();
  if (rays_.size() > 1 && rays_.back().slope < rays_.front().slope) std::reverse(rays_.begin(), end);
  // Beams come in order of their angles but for where the scan begins: few sorted pieces.
  constexpr int kFewPieces = 6;
  auto sorted_end = std::is_sorted_until(rays_.begin(), end, by_slope);
  for (int piece = 0; sorted_end != end; ++piece) {
    if (piece == kFewPieces) {
      std::sort(rays_.begin(), end, by_slope);
      return;
    }
    const auto next_end = std::is_sorted_until(sorted_end, end, by_slope);
    std::inplace_merge(rays_.begin(), sorted_end, next_end, by_slope);
    sorted_end = next_end;
  }
}

void RayFan::Side::Arrange(double first, int num_steps) {
  first_ = first;
  Sort();
  const std::size_t num_words = (rays_.size() + 63) / 64;
  alive_.assign(num_words, 0);
  fused_.assign(num_words, 0);
  ending_.Reset(num_steps + 1);
  parting_.Reset(num_steps + 1);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Ray& ray = rays_[i];
    alive_[i / 64] |= Bit(i);
    ending_.Add(ray.crossings, static_cast<std::uint32_t>(i));
    if (i + 1 == rays_.size()) break;
    fused_[i / 64] |= Bit(i);
    // In step s the inner border is first + s - 1 away.
    const double last_fused_step = FusedReach(ray.slope, rays_[i + 1].slope) - first + 1.0;
    if (last_fused_step >= std::min(ray.crossings, rays_[i + 1].crossings)) continue;
    parting_.Add(static_cast<int>(std::floor(last_fused_step)) + 1, static_cast<std::uint32_t>(i));
  }
}

void RayFan::Side::AppendSpans(int step, double x, std::vector<ColumnSpan>* spans) {
  const double inner = first_ + step - 1;
  ending_.ForEach(step, [&](std::uint32_t i) {
    alive_[i / 64] &= ~Bit(i);
    fused_[i / 64] &= ~Bit(i);
    if (i > 0) fused_[(i - 1) / 64] &= ~Bit(i - 1);
    const int column = static_cast<int>(x + inner * rays_[i].slope);
    if (column != rays_[i].end_column) spans->push_back(UpToEnd(column, rays_[i].end_column));
  });
  parting_.ForEach(step, [&](std::uint32_t i) { fused_[i / 64] &= ~Bit(i); });
  AppendRuns(step, x, spans);
}

void RayFan::Side::AppendRuns(int step, double x, std::vector<ColumnSpan>* spans) const {
  const double inner = std::max(first_ + step - 1, 0.0);  // step 0 begins at the origin itself
  const double outer = first_ + step;
  const auto lowest_column = [&](std::size_t i) {
    const double slope = rays_[i].slope;
    return static_cast<int>(x + (slope < 0.0 ? outer : inner) * slope);
  };
  const auto highest_column = [&](std::size_t i) {
    const double slope = rays_[i].slope;
    return static_cast<int>(x + (slope < 0.0 ? inner : outer) * slope);
  };
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
      spans->push_back({first_column, highest_column(64 * word + static_cast<std::size_t>(std::countr_zero(ends)))});
    }
    if (begins != 0) {
      take_begin();
      in_run = true;
    }
  }
}

}  // namespace survey
