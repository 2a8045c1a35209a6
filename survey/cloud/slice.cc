// SPDX-License-Identifier: Apache-2.0
#include "survey/cloud/slice.h"

#include <cmath>

namespace survey {

void CloudSlice::Add(const Eigen::Vector3d& p_in_site) {
  if (p_in_site.z() < options_.from_elevation_m || p_in_site.z() > options_.to_elevation_m) return;
  const std::pair<std::int64_t, std::int64_t> cell(std::llround(std::floor(p_in_site.x() / options_.cell_m)),
                                                   std::llround(std::floor(p_in_site.y() / options_.cell_m)));
  Sum& sum = cells_[cell];
  const Eigen::Vector2d corner(static_cast<double>(cell.first) * options_.cell_m,
                               static_cast<double>(cell.second) * options_.cell_m);
  sum.sum += p_in_site.head<2>() - corner;  // small numbers: coordinates have seven digits before the point
  ++sum.count;
}

std::vector<Eigen::Vector2d> CloudSlice::Points() const {
  std::vector<Eigen::Vector2d> points;
  for (const auto& [cell, sum] : cells_) {
    const Eigen::Vector2d corner(static_cast<double>(cell.first) * options_.cell_m,
                                 static_cast<double>(cell.second) * options_.cell_m);
    points.emplace_back(corner + sum.sum / static_cast<double>(sum.count));
  }
  return points;
}

}  // namespace survey
