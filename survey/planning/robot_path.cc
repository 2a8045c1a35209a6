// SPDX-License-Identifier: Apache-2.0
#include "survey/planning/robot_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "survey/grid/raster_strips.h"

namespace survey {
namespace {

using Eigen::Vector2d;

struct Step {
  int columns;
  int rows;
  float cells;  // length
};

constexpr auto kDiagonal = static_cast<float>(std::numbers::sqrt2);
constexpr std::array<Step, 8> kSteps = {{{1, 0, 1},
                                         {0, 1, 1},
                                         {-1, 0, 1},
                                         {0, -1, 1},
                                         {1, 1, kDiagonal},
                                         {-1, 1, kDiagonal},
                                         {-1, -1, kDiagonal},
                                         {1, -1, kDiagonal}}};

// Shortest way over free cells alone: never longer than the real one.
float FreeWay(int columns, int rows) {
  const int straight = std::max(std::abs(columns), std::abs(rows));
  const int diagonal = std::min(std::abs(columns), std::abs(rows));
  return static_cast<float>(straight - diagonal) + kDiagonal * static_cast<float>(diagonal);
}

struct Candidate {
  float estimate;  // way to the goal through this cell
  std::size_t cell;

  // Equal estimates in the order of cells: the same way on every machine.
  bool operator>(const Candidate& other) const {
    return estimate != other.estimate ? estimate > other.estimate : cell > other.cell;
  }
};

constexpr std::uint8_t kNoStep = 255;

}  // namespace

RobotSpace::RobotSpace(const SiteRaster& map, const RobotOptions& options)
    : frame_(FrameOf(map)), radius_m_(options.radius_m) {
  // With a rim of walls, for what lies outside of the map is not known.
  cv::Mat open = cv::Mat::zeros(map.height + 2, map.width + 2, CV_8U);
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const float log_odds = map.At(column, row);
      const bool wall = std::isnan(log_odds) || ProbabilityFromLogOdds(log_odds) >= options.occupied_probability;
      open.at<std::uint8_t>(row + 1, column + 1) = wall ? 0 : 1;
    }
  }
  cv::Mat distance;
  cv::distanceTransform(open, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  clearance_m_.reserve(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column)
      clearance_m_.push_back(distance.at<float>(row + 1, column + 1) * static_cast<float>(map.cell_size_m));
  }
}

double RobotSpace::ClearanceAt(const Vector2d& place) const {
  const auto cell = frame_.CellOf(place);
  if (!frame_.Contains(cell.x(), cell.y())) return 0.0;
  return static_cast<double>(clearance_m_[frame_.Index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))]);
}

std::vector<Vector2d> RobotSpace::Path(const Vector2d& start, const Vector2d& goal) const {
  if (ClearanceAt(start) < radius_m_ || ClearanceAt(goal) < radius_m_) return {};
  const auto width = static_cast<std::size_t>(frame_.width);
  const auto index_of = [&](const Vector2d& place) {
    const auto cell = frame_.CellOf(place);
    return frame_.Index(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
  };
  const std::size_t first = index_of(start);
  const std::size_t last = index_of(goal);
  const auto to_goal = [&](std::size_t cell) {
    return FreeWay(static_cast<int>(cell % width) - static_cast<int>(last % width),
                   static_cast<int>(cell / width) - static_cast<int>(last / width));
  };
  std::vector<float> way(clearance_m_.size(), std::numeric_limits<float>::max());
  std::vector<std::uint8_t> step_to(clearance_m_.size(), kNoStep);
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  way[first] = 0.0F;
  candidates.push({to_goal(first), first});
  while (!candidates.empty() && candidates.top().cell != last) {
    const Candidate here = candidates.top();
    candidates.pop();
    if (here.estimate > way[here.cell] + to_goal(here.cell)) continue;  // a shorter way was found since
    for (std::uint8_t k = 0; k < kSteps.size(); ++k) {
      const int column = static_cast<int>(here.cell % width) + kSteps[k].columns;
      const int row = static_cast<int>(here.cell / width) + kSteps[k].rows;
      if (!frame_.Contains(column, row)) continue;
      const std::size_t next = frame_.Index(column, row);
      const float length = way[here.cell] + kSteps[k].cells;
      if (!IsOpen(next) || length >= way[next]) continue;
      way[next] = length;
      step_to[next] = k;
      candidates.push({length + to_goal(next), next});
    }
  }
  if (candidates.empty()) return {};
  std::vector<Vector2d> path;
  for (std::size_t cell = last;;) {
    const int column = static_cast<int>(cell % width);
    const int row = static_cast<int>(cell / width);
    path.push_back(frame_.CentreOf(column, row));
    if (cell == first) break;
    const Step& step = kSteps[step_to[cell]];
    cell = frame_.Index(column - step.columns, row - step.rows);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

double LengthOf(const std::vector<Vector2d>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

}  // namespace survey
