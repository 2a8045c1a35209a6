// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/ray_fan.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

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
  in_origin_row_.clear();
}

void RayFan::Add(double x, double y, int column, int row) {
  if (row > row_) {
    above_.Add((x - x_) / (y - y_), row - row_, column);
  } else if (row < row_) {
    below_.Add((x - x_) / (y_ - y), row_ - row, column);
  } else if (column != column_) {
    in_origin_row_.push_back(UpToEnd(column_, column));
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

}  // namespace survey
