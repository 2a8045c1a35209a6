// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace survey {

// Share of the full turn about a centre in which points lie, in steps of 15 degrees.
inline double ArcShare(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& centre) {
  constexpr int kSectors = 24;
  std::array<bool, kSectors> seen{};
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d out = p - centre;
    const double turn = std::atan2(out.y(), out.x()) / (2 * std::numbers::pi) + 0.5;
    seen[static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1))] = true;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / kSectors;
}

}  // namespace survey
