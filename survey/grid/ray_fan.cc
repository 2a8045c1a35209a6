// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/ray_fan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace survey {
namespace {

// Distance outwards, from the inner border of a row, up to which no whole cell fits between two rays with slopes
// a <= b. One leaves the row where it crosses the outer border, the other enters it at the inner one.
double FusedReach(double a, double b) {
  constexpr double kSafe = 1.0 - 1e-9;  // rounding must not fuse what has parted
  return kSafe * (1.0 + std::max(a, 0.0) + std::max(-b, 0.0)) / (b - a);
}

// Marks the cells of a ray in its last row, from the column that it enters by to the one before its end.
void MarkUpTo(int end_column, int column, CellBits::Line row) {
  if (column < end_column) row.Add(column, end_column - 1);
  if (column > end_column) row.Add(end_column + 1, column);
}

}  // namespace

void RayFan::Begin(double x, double y) {
  x_ = x;
  y_ = y;
  column_ = static_cast<int>(x);
  row_ = static_cast<int>(y);
  above_.Clear();
  below_.Clear();
  in_origin_row_.clear();
}

void RayFan::Add(double x, double y, int column, int row) {
  if (row > row_) {
    above_.Add((x - x_) / (y - y_), row - row_, column);
  } else if (row < row_) {
    below_.Add((x - x_) / (y_ - y), row_ - row, column);
  } else {
    in_origin_row_.push_back(column);
  }
}

void RayFan::Mark(CellBits* crossed) {
  for (const int end_column : in_origin_row_) MarkUpTo(end_column, column_, crossed->LineOf(row_));
  const double to_below = y_ - row_;
  above_.Mark(x_, 1.0 - to_below, row_, 1, crossed);
  below_.Mark(x_, to_below, row_, -1, crossed);
}

void RayFan::Side::Mark(double x, double first, int row, int direction, CellBits* crossed) {
  x_ = x;
  first_ = first;
  row_ = row;
  direction_ = direction;
  crossed_ = crossed;
  Sort();
  Arrange();
  for (int step = 0; step < num_steps_; ++step) {
    leaving_.ForEach(step, [&](std::uint32_t i) { alive_[i / 64] &= ~Bit(i); });
    parting_.ForEach(step, [&](std::uint32_t i) { fused_[i / 64] &= ~Bit(i); });
    MarkRuns(step);
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

int RayFan::Side::FirstStepApart(std::size_t i) const {
  if (i + 1 >= rays_.size()) return 0;
  const int both_cross = std::min(rays_[i].crossings, rays_[i + 1].crossings);
  // In step s the inner border is first + s - 1 away.
  const double last_fused_step = FusedReach(rays_[i].slope, rays_[i + 1].slope) - first_ + 1.0;
  return last_fused_step >= both_cross ? both_cross : static_cast<int>(std::floor(last_fused_step)) + 1;
}

void RayFan::Side::Arrange() {
  const std::size_t num_words = (rays_.size() + 63) / 64;
  alive_.assign(num_words, 0);
  fused_.assign(num_words, 0);
  int farthest = 0;
  for (const Ray& ray : rays_) farthest = std::max(farthest, ray.crossings);
  leaving_.Reset(farthest + 1);
  parting_.Reset(farthest + 1);
  num_steps_ = 0;
  int apart_before = 0;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const int apart = FirstStepApart(i);
    const int alone = std::max(apart_before, apart);
    apart_before = apart;
    num_steps_ = std::max(num_steps_, alone);
    FollowToEnd(rays_[i], alone);
    if (alone > 0) alive_[i / 64] |= Bit(i);
    if (apart > 0) fused_[i / 64] |= Bit(i);
    leaving_.Add(alone, static_cast<std::uint32_t>(i));
    if (apart > 0) parting_.Add(apart, static_cast<std::uint32_t>(i));
  }
}

// Border k is the one that step k - 1 ends and step k begins with; step 0 begins at the origin itself.
int RayFan::Side::ColumnAt(const Ray& ray, int border) const {
  return static_cast<int>(x_ + std::max(first_ + border - 1, 0.0) * ray.slope);
}

// Marks what a ray crosses from a step on.
void RayFan::Side::FollowToEnd(const Ray& ray, int first_step) {
  CellBits::Line row = crossed_->LineOf(row_ + direction_ * first_step);
  int column = ColumnAt(ray, first_step);
  for (int step = first_step; step < ray.crossings; ++step, row.Move(direction_)) {
    const int next_column = static_cast<int>(x_ + (first_ + step) * ray.slope);
    row.Add(std::min(column, next_column), std::max(column, next_column));
    column = next_column;
  }
  MarkUpTo(ray.end_column, column, row);
}

void RayFan::Side::MarkRuns(int step) {
  CellBits::Line row = crossed_->LineOf(row_ + direction_ * step);
  const auto lowest_column = [&](std::size_t i) { return ColumnAt(rays_[i], rays_[i].slope < 0.0 ? step + 1 : step); };
  const auto highest_column = [&](std::size_t i) { return ColumnAt(rays_[i], rays_[i].slope < 0.0 ? step : step + 1); };
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
      row.Add(first_column, highest_column(64 * word + static_cast<std::size_t>(std::countr_zero(ends))));
    }
    if (begins != 0) {
      take_begin();
      in_run = true;
    }
  }
}

}  // namespace survey
