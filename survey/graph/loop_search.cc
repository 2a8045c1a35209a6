// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/loop_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <queue>

#include "survey/graph/block_graph.h"
#include "survey/matching/branch_and_bound.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

constexpr double kChiSquare3 = 16.27;   // 99.9 %, three degrees of freedom
constexpr double kLoopLength_m = 1.0;   // a loop counts as this much way
constexpr double kFirstSpacing = 4.0;   // times wider before the last round
constexpr double kNeighbours_m = 25.0;  // loops of one submap this close along the track must agree

// How far the track may have drifted between two places, as a function of the way between them.
struct Drift {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

class LoopSearch {
 public:
  LoopSearch(const Session& session, const Track& track, const LoopOptions& options)
      : session_(session),
        track_(track),
        options_(options),
        projector_(session.geometries, options.max_range_m, 0.0),
        block_(MakeBlockGraph(track)) {
    way_.push_back(0.0);
    for (std::size_t n = 1; n < block_.nodes.size(); ++n)
      way_.push_back(way_.back() + Between(LocalPose(n - 1), LocalPose(n)).Translation().norm());
  }

  Loops Run(const std::function<void(std::size_t, std::size_t)>& progress) {
    const std::size_t total = track_.submaps.size() * static_cast<std::size_t>(options_.rounds);
    std::atomic<std::size_t> done = 0;
    std::mutex progress_mutex;
    for (int round = 0; round < options_.rounds; ++round) {
      // Wide windows are dear: a few nodes do until the first loops have narrowed them.
      const double spacing_m = options_.node_spacing_m * (round + 1 < options_.rounds ? kFirstSpacing : 1.0);
      std::vector<std::vector<Loop>> found(track_.submaps.size());
      std::vector<int> searched(track_.submaps.size(), 0);
      tbb::parallel_for(std::size_t{0}, track_.submaps.size(), [&](std::size_t s) {
        searched[s] = SearchSubmap(track_.submaps[s], spacing_m, &found[s]);
        KeepMutuallyConsistent(&found[s]);
        ++done;
        const std::lock_guard lock(progress_mutex);
        if (progress) progress(done, total);
      });
      result_ = {};
      for (std::size_t s = 0; s < found.size(); ++s) {
        result_.candidates_searched += searched[s];
        for (Loop& loop : found[s]) result_.loops.push_back(std::move(loop));
      }
      CloseLoops();
    }
    return std::move(result_);
  }

 private:
  const Pose2& LocalPose(std::size_t node) const {
    return track_.scans[static_cast<std::size_t>(block_.nodes[node].value)].local_from_scan;
  }
  const Pose2& Pose(std::size_t node) const { return block_.graph.poses[block_.num_submaps + node]; }
  std::size_t NodeIndex(ScanId scan) const {
    return static_cast<std::size_t>(block_.PoseOf(scan)) - block_.num_submaps;
  }

  Drift DriftOver(double way_m) const {
    return {0.05 + options_.drift_m_per_m * way_m, 0.01 + options_.drift_rad_per_sqrt_m * std::sqrt(way_m)};
  }

  std::vector<double> ShortestWays(const Submap& submap) const;
  std::vector<std::size_t> Candidates(const Submap& submap, const std::vector<double>& ways, double spacing_m) const;
  int SearchSubmap(const Submap& submap, double spacing_m, std::vector<Loop>* loops) const;
  std::optional<Loop> SearchNode(const Submap& submap, const OccupancyPyramid& grid, const SlidingMaximumGrids& grids,
                                 double own_score, std::size_t node, const Drift& drift) const;
  void PointsOfNode(std::size_t node, std::vector<Eigen::Vector2f>* points) const;
  void KeepMutuallyConsistent(std::vector<Loop>* loops) const;
  void CloseLoops();

  const Session& session_;
  const Track& track_;
  const LoopOptions& options_;
  ScanProjector projector_;
  BlockGraph block_;         // poses of the current round
  std::vector<double> way_;  // along the track, by node
  Loops result_;
};

// Length of the shortest way from the submap to every node: along the track or through loops that are closed already.
// Vertices: nodes, then submaps; a node hangs on its submap by the way to the submap's middle node.
std::vector<double> LoopSearch::ShortestWays(const Submap& submap) const {
  const std::size_t num_nodes = block_.nodes.size();
  struct Arc {
    std::size_t to;
    double length;
  };
  std::vector<std::vector<Arc>> arcs(num_nodes + track_.submaps.size());
  const auto connect = [&](std::size_t a, std::size_t b, double length) {
    arcs[a].push_back({b, length});
    arcs[b].push_back({a, length});
  };
  for (std::size_t n = 1; n < num_nodes; ++n) connect(n - 1, n, way_[n] - way_[n - 1]);
  for (const Submap& other : track_.submaps) {
    const double middle = way_[NodeIndex(other.nodes[other.nodes.size() / 2])];
    for (const ScanId node : other.nodes) {
      const std::size_t n = NodeIndex(node);
      connect(n, num_nodes + static_cast<std::size_t>(other.id.value), std::abs(way_[n] - middle));
    }
  }
  for (const Loop& loop : result_.loops) {
    if (loop.accepted)
      connect(NodeIndex(loop.constraint.scan), num_nodes + static_cast<std::size_t>(loop.constraint.submap.value),
              kLoopLength_m);
  }
  std::vector<double> ways(arcs.size(), std::numeric_limits<double>::max());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  ways[num_nodes + static_cast<std::size_t>(submap.id.value)] = 0.0;
  queue.emplace(0.0, num_nodes + static_cast<std::size_t>(submap.id.value));
  while (!queue.empty()) {
    const auto [way, vertex] = queue.top();
    queue.pop();
    if (way > ways[vertex]) continue;
    for (const Arc& arc : arcs[vertex]) {
      if (way + arc.length >= ways[arc.to]) continue;
      ways[arc.to] = way + arc.length;
      queue.emplace(ways[arc.to], arc.to);
    }
  }
  return ways;
}

// Nodes worth a search: far along the track, near by position as far as drift allows, and not too many of one pass.
std::vector<std::size_t> LoopSearch::Candidates(const Submap& submap, const std::vector<double>& ways,
                                                double spacing_m) const {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < submap.nodes.size(); i += 5)
    places.push_back(Pose(NodeIndex(submap.nodes[i])).Translation());
  const double first_way = way_[NodeIndex(submap.nodes.front())];
  const double last_way = way_[NodeIndex(submap.nodes.back())];
  std::vector<std::size_t> candidates;
  double last_candidate = -std::numeric_limits<double>::max();
  for (std::size_t n = 0; n < block_.nodes.size(); ++n) {
    const double detour = std::max(first_way - way_[n], way_[n] - last_way);
    if (detour < options_.min_detour_m || way_[n] - last_candidate < spacing_m) continue;
    const double reach = options_.reach_m + std::min(2.0 * DriftOver(ways[n]).sigma_m, options_.max_window_m);
    const Eigen::Vector2d place = Pose(n).Translation();
    const bool near =
        std::any_of(places.begin(), places.end(), [&](const Eigen::Vector2d& p) { return (p - place).norm() < reach; });
    if (!near) continue;
    candidates.push_back(n);
    last_candidate = way_[n];
  }
  return candidates;
}

void LoopSearch::PointsOfNode(std::size_t node, std::vector<Eigen::Vector2f>* points) const {
  const auto scan = static_cast<std::size_t>(block_.nodes[node].value);
  ScanPoints projected;
  const auto pose_of = [&](std::size_t i) { return track_.scans[i].local_from_scan; };
  projector_.Project(session_.scans[scan], TwistOfScan(session_.scans, pose_of, scan), &projected);
  ThinAlongScan(projected.hits, options_.point_spacing_m, static_cast<std::size_t>(options_.max_points), points);
}

// Share of the points on cells that the map has seen, and the mean occupancy there.
struct Overlap {
  double share = 0.0;
  double occupancy = 0.0;
};
Overlap MeasureOverlap(const OccupancyPyramid& grid, std::span<const Eigen::Vector2f> points,
                       const Pose2& map_from_scan) {
  std::vector<Eigen::Vector2f> in_map;
  TransformPoints(map_from_scan, points, &in_map);
  const auto cells_per_m = static_cast<float>(1.0 / grid.cell_size_m(1));
  double seen = 0.0;
  double sum = 0.0;
  for (const Eigen::Vector2f& p : in_map) {
    const OccupancyPyramid::Evidence evidence = grid.At(1, static_cast<int>(std::floor(p.x() * cells_per_m)),
                                                        static_cast<int>(std::floor(p.y() * cells_per_m)));
    if (evidence == OccupancyPyramid::kUnknown) continue;
    seen += 1.0;
    sum += static_cast<double>(grid.OccupancyOf(evidence));
  }
  return {points.empty() ? 0.0 : seen / static_cast<double>(points.size()), seen > 0.0 ? sum / seen : 0.0};
}

int LoopSearch::SearchSubmap(const Submap& submap, double spacing_m, std::vector<Loop>* loops) const {
  const std::vector<double> ways = ShortestWays(submap);
  const std::vector<std::size_t> candidates = Candidates(submap, ways, spacing_m);
  if (candidates.empty()) return 0;
  const OccupancyPyramid grid = DrawSubmap(session_, track_, submap, projector_, options_.grid);
  const SlidingMaximumGrids grids(grid, 1, 7);

  double own_score = 0.0;
  double own_count = 0.0;
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = 0; i < submap.nodes.size(); i += 10) {
    const std::size_t n = NodeIndex(submap.nodes[i]);
    PointsOfNode(n, &points);
    own_score += MeasureOverlap(grid, points, Between(submap.local_from_submap, LocalPose(n))).occupancy;
    own_count += 1.0;
  }
  own_score /= own_count;
  for (const std::size_t node : candidates) {
    if (std::optional<Loop> loop = SearchNode(submap, grid, grids, own_score, node, DriftOver(ways[node])))
      loops->push_back(*std::move(loop));
  }
  return static_cast<int>(candidates.size());
}

std::optional<Loop> LoopSearch::SearchNode(const Submap& submap, const OccupancyPyramid& grid,
                                           const SlidingMaximumGrids& grids, double own_score, std::size_t node,
                                           const Drift& drift) const {
  std::vector<Eigen::Vector2f> points;
  PointsOfNode(node, &points);
  const Pose2 predicted = Between(block_.graph.poses[static_cast<std::size_t>(submap.id.value)], Pose(node));
  const double required = options_.min_score_ratio * own_score;
  const SearchWindow window{.half_width_m = std::min(3.0 * drift.sigma_m, options_.max_window_m),
                            .half_angle_rad = std::min(3.0 * drift.sigma_rad, options_.max_window_rad),
                            .min_score = options_.min_overlap * required};
  const std::optional<SearchResult> found = BranchAndBound(grids, points, predicted, window);
  if (!found) return std::nullopt;
  const Eigen::Matrix3d covariance =
      Eigen::Vector3d(drift.sigma_m * drift.sigma_m, drift.sigma_m * drift.sigma_m, drift.sigma_rad * drift.sigma_rad)
          .asDiagonal();
  const MatchResult match = MatchScan(grid, points, found->map_from_scan, predicted, covariance, options_.match);
  if (!match.usable) return std::nullopt;
  const Overlap overlap = MeasureOverlap(grid, points, match.map_from_scan);
  if (overlap.share < options_.min_overlap || overlap.occupancy < required) return std::nullopt;
  Loop loop;
  loop.constraint = {submap.id, block_.nodes[node], match.map_from_scan, match.covariance};
  loop.constraint.covariance.diagonal() += Eigen::Vector3d(4e-4, 4e-4, 1e-5);  // the submap's own bending, cell size
  loop.score = overlap.occupancy;
  return loop;
}

// Loops of one submap with neighbouring nodes must tell the same story as the track between these nodes; those that
// most neighbours contradict are dropped, and so are loners among contradictions.
void LoopSearch::KeepMutuallyConsistent(std::vector<Loop>* loops) const {
  std::vector<int> agree(loops->size(), 0);
  std::vector<int> disagree(loops->size(), 0);
  for (std::size_t a = 0; a < loops->size(); ++a) {
    for (std::size_t b = a + 1; b < loops->size(); ++b) {
      const SubmapConstraint& first = (*loops)[a].constraint;
      const SubmapConstraint& second = (*loops)[b].constraint;
      const std::size_t first_node = NodeIndex(first.scan);
      const std::size_t second_node = NodeIndex(second.scan);
      const double way = std::abs(way_[second_node] - way_[first_node]);
      if (way > kNeighbours_m) continue;
      const Pose2 by_loops = Between(first.submap_from_scan, second.submap_from_scan);
      const Pose2 by_track = Between(LocalPose(first_node), LocalPose(second_node));
      const Pose2 difference = Between(by_track, by_loops);
      const double variance_m = 0.0025 + std::pow(options_.drift_m_per_m * way, 2) +
                                first.covariance.topLeftCorner<2, 2>().trace() +
                                second.covariance.topLeftCorner<2, 2>().trace();
      const double variance_rad =
          1e-4 + std::pow(options_.drift_rad_per_sqrt_m, 2) * way + first.covariance(2, 2) + second.covariance(2, 2);
      const double square =
          difference.Translation().squaredNorm() / variance_m + difference.theta * difference.theta / variance_rad;
      (square < kChiSquare3 ? agree : disagree)[a] += 1;
      (square < kChiSquare3 ? agree : disagree)[b] += 1;
    }
  }
  for (std::size_t i = 0; i < loops->size(); ++i) {
    if (disagree[i] > agree[i]) {
      (*loops)[i].accepted = false;
      (*loops)[i].reason = "contradicts its neighbours";
    } else if (agree[i] == 0) {
      (*loops)[i].accepted = false;
      (*loops)[i].reason = "no neighbour agrees";
    }
  }
}

// Solves with the accepted loops under a robust loss and drops those that the whole graph contradicts.
void LoopSearch::CloseLoops() {
  for (int pass = 0; pass < 2; ++pass) {
    block_ = MakeBlockGraph(track_);
    for (const Loop& loop : result_.loops) {
      if (loop.accepted) AddLoop(loop.constraint, &block_);
    }
    Solve(&block_.graph, {.chordal_start = pass == 0});
    for (Loop& loop : result_.loops) {
      if (!loop.accepted) continue;
      const PoseEdge edge{block_.PoseOf(loop.constraint.submap), block_.PoseOf(loop.constraint.scan),
                          loop.constraint.submap_from_scan, loop.constraint.covariance, true};
      if (SquaredNormalisedResidual(edge, block_.graph.poses) > 3.0 * kChiSquare3) {
        loop.accepted = false;
        loop.reason = "contradicts the rest of the block";
      }
    }
  }
}

}  // namespace

Loops FindLoops(const Session& session, const Track& track, const LoopOptions& options,
                const std::function<void(std::size_t, std::size_t)>& progress) {
  if (track.submaps.empty()) return {};
  return LoopSearch(session, track, options).Run(progress);
}

}  // namespace survey
