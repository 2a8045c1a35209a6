// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/map_arrow.h"

#include <algorithm>
#include <set>

namespace survey {
namespace {

// How well a person points at a place in the map is part of the arrow's sigma.
constexpr double kTailVariance_m2 = 1e-6;

std::string PointOf(const MapArrow& arrow) { return "arrow " + arrow.name; }

std::set<std::string> PointsOf(const std::vector<MapArrow>& arrows) {
  std::set<std::string> points;
  for (const MapArrow& arrow : arrows) points.insert(PointOf(arrow));
  return points;
}

Eigen::Matrix2d CovarianceOf(const MapArrow& arrow) {
  return arrow.sigma_m * arrow.sigma_m * Eigen::Matrix2d::Identity();
}

// The node nearest in time to a scan.
std::size_t NearestNode(std::size_t scan, const std::vector<TrackedScan>& scans) {
  std::size_t nearest = scans.size();
  const auto distance = [&](std::size_t i) { return i > scan ? i - scan : scan - i; };
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (scans[i].is_node && (nearest == scans.size() || distance(i) < distance(nearest))) nearest = i;
  }
  return nearest;
}

void AddMark(const MapArrow& arrow, std::size_t scan, Track* track) {
  const std::size_t node = NearestNode(scan, track->scans);
  const Pose2 node_from_scan = Between(track->scans[node].local_from_scan, track->scans[scan].local_from_scan);
  TrackedMark mark{.point = PointOf(arrow), .start_ns = arrow.tail.stamp_ns, .end_ns = arrow.tail.stamp_ns};
  mark.scan = track->scans[node].scan;
  mark.mark_in_scan = node_from_scan * arrow.tail.p_in_scan;
  mark.covariance = kTailVariance_m2 * Eigen::Matrix2d::Identity();
  const auto place =
      std::upper_bound(track->marks.begin(), track->marks.end(), mark,
                       [](const TrackedMark& a, const TrackedMark& b) { return a.start_ns < b.start_ns; });
  track->marks.insert(place, mark);
}

// Points stay in order of their names, and correlations with their points.
void AddPoint(const MapArrow& arrow, ControlNetwork* control) {
  ControlPoint point{.name = PointOf(arrow), .role = PointRole::kControl, .position_in_site = arrow.head_in_site};
  point.covariance = CovarianceOf(arrow);
  point.description = "drawn by a person";
  const auto place = std::lower_bound(control->points.begin(), control->points.end(), point,
                                      [](const ControlPoint& a, const ControlPoint& b) { return a.name < b.name; });
  const int index = static_cast<int>(place - control->points.begin());
  for (PointCorrelation& pair : control->correlations) {
    pair.a += pair.a >= index ? 1 : 0;
    pair.b += pair.b >= index ? 1 : 0;
  }
  control->points.insert(place, point);
}

}  // namespace

std::vector<std::string> AddArrows(const std::vector<MapArrow>& arrows, const std::vector<StampNs>& stamps,
                                   Track* track, ControlNetwork* control) {
  std::vector<std::string> lost;
  for (const MapArrow& arrow : arrows) {
    const auto found = std::lower_bound(stamps.begin(), stamps.end(), arrow.tail.stamp_ns);
    if (found == stamps.end() || *found != arrow.tail.stamp_ns) {
      lost.push_back(arrow.name);
      continue;
    }
    AddMark(arrow, static_cast<std::size_t>(found - stamps.begin()), track);
    AddPoint(arrow, control);
  }
  return lost;
}

void KeepArrows(const std::vector<MapArrow>& arrows, const Solution& solution, ControlledGraph* graph) {
  if (arrows.empty()) return;
  const std::set<std::string> points = PointsOf(arrows);
  std::vector<MarkEdge> of_arrows;
  std::vector<MarkEdge> others;
  for (std::size_t i = 0; i < solution.marks.size(); ++i)
    (points.contains(solution.marks[i].point) ? of_arrows : others).push_back(graph->block.graph.marks[i]);
  others.insert(others.end(), of_arrows.begin(), of_arrows.end());
  graph->block.graph.marks = std::move(others);
  const std::vector<std::string>& names = graph->block.point_names;
  for (const MapArrow& arrow : arrows) {
    if (std::erase(graph->control, PointOf(arrow)) == 0) continue;
    const auto index = std::find(names.begin(), names.end(), PointOf(arrow)) - names.begin();
    graph->block.graph.given.push_back({{static_cast<int>(index)}, arrow.head_in_site, CovarianceOf(arrow)});
  }
}

std::vector<SolvedMark> TakeArrows(const std::vector<MapArrow>& arrows, Solution* solution) {
  const std::set<std::string> points = PointsOf(arrows);
  std::vector<SolvedMark> taken;
  std::erase_if(solution->marks, [&](const SolvedMark& mark) {
    if (!points.contains(mark.point)) return false;
    taken.push_back(mark);
    return true;
  });
  return taken;
}

bool IsTiedByControl(const Track& track, const ControlNetwork& control) {
  std::set<std::string> points;
  for (const ControlPoint& point : control.points) {
    const bool marked = std::any_of(track.marks.begin(), track.marks.end(),
                                    [&](const TrackedMark& mark) { return mark.point == point.name; });
    if (marked && point.role == PointRole::kControl) points.insert(point.name);
  }
  return points.size() >= 2;
}

}  // namespace survey
