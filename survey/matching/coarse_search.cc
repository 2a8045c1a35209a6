// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/coarse_search.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

struct Scored {
  Pose2 pose;
  int dx = 0;
  int dy = 0;
  int angle = 0;
  float score = 0.0F;
};

bool Close(const Scored& a, const Scored& b) {
  return std::abs(a.dx - b.dx) < 2 && std::abs(a.dy - b.dy) < 2 && std::abs(a.angle - b.angle) < 2;
}

}  // namespace

std::vector<Pose2> CoarseSearch(const OccupancyPyramid& map, std::span<const Eigen::Vector2f> points_in_scan,
                                const Pose2& centre, double half_width_m, double half_angle_rad,
                                const CoarseSearchOptions& options) {
  if (points_in_scan.empty()) return {};
  const int level = std::min(options.level, map.num_levels() - 1);
  const double step_m = map.cell_size_m(level);
  double mean_range = 0.0;
  for (const Eigen::Vector2f& p : points_in_scan) mean_range += static_cast<double>(p.norm());
  mean_range = std::max(mean_range / static_cast<double>(points_in_scan.size()), 1.0);
  const double step_rad = step_m / mean_range;
  const int shifts = static_cast<int>(std::ceil(half_width_m / step_m));
  const int turns = static_cast<int>(std::ceil(half_angle_rad / step_rad));

  std::vector<Scored> scored;
  std::vector<Eigen::Vector2i> cells(points_in_scan.size());
  const auto cells_per_m = static_cast<float>(1.0 / step_m);
  for (int turn = -turns; turn <= turns; ++turn) {
    const double theta = centre.theta + turn * step_rad;
    const auto c = static_cast<float>(std::cos(theta));
    const auto s = static_cast<float>(std::sin(theta));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Eigen::Vector2f& p = points_in_scan[i];
      cells[i] = {static_cast<int>(std::floor((c * p.x() - s * p.y() + static_cast<float>(centre.x)) * cells_per_m)),
                  static_cast<int>(std::floor((s * p.x() + c * p.y() + static_cast<float>(centre.y)) * cells_per_m))};
    }
    for (int dx = -shifts; dx <= shifts; ++dx) {
      for (int dy = -shifts; dy <= shifts; ++dy) {
        float sum = 0.0F;
        for (const Eigen::Vector2i& cell : cells) sum += map.OccupancyOf(map.At(level, cell.x() + dx, cell.y() + dy));
        scored.push_back({{centre.x + dx * step_m, centre.y + dy * step_m, NormalizeAngle(theta)}, dx, dy, turn, sum});
      }
    }
  }
  std::stable_sort(scored.begin(), scored.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<Scored> modes;
  for (const Scored& candidate : scored) {
    if (std::any_of(modes.begin(), modes.end(), [&](const Scored& mode) { return Close(mode, candidate); })) continue;
    modes.push_back(candidate);
    if (modes.size() == options.max_modes) break;
  }
  std::vector<Pose2> poses;
  for (const Scored& mode : modes) poses.push_back(mode.pose);
  return poses;
}

}  // namespace survey
