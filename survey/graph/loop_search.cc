// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/loop_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "survey/graph/block_graph.h"
#include "survey/graph/loop_consistency.h"
#include "survey/graph/loop_ways.h"

namespace survey {
namespace {

// Every so many submaps are searched in the rounds before the last: the first loops narrow the windows of the others.
constexpr std::array<std::size_t, 5> kClosingRounds = {8, 4, 2, 2, 2};
constexpr double kClosingSpacing_m = 4.0;    // between nodes that are searched while loops are being closed
constexpr double kNarrow_m = 0.5;            // windows up to here are in the reach of a match ...
constexpr double kNarrow_rad = 0.2;          // ... from the prediction
constexpr std::size_t kPlacesOfSubmap = 24;  // its nodes that tell where it lies
constexpr double kBlindDrift = 10.0;         // of odometry, times that of matched scans
constexpr double kNegligibleCost = 0.1;      // all nodes together move by half a sigma

// A node to be searched in a submap.
struct Candidate {
  std::size_t node = 0;
  Pose2 predicted;  // submap_from_scan
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
  double away_m = 0.0;  // from the nearest of the submap's nodes

  bool Narrow() const { return 3.0 * sigma_m <= kNarrow_m && 3.0 * sigma_rad <= kNarrow_rad; }
};

// What a search came to.
struct Attempt {
  Candidate candidate;
  std::optional<Loop> loop;
};

// While loops are being closed, a few nodes are searched in submaps that do not overlap; in the end many nodes in all
// submaps, but where windows are still wide.
enum class Round { kClosing, kLast };

// Those nearest to the submap's nodes see most of it.
void KeepNearest(std::size_t most, std::vector<Candidate>* candidates) {
  if (candidates->size() <= most) return;
  std::sort(candidates->begin(), candidates->end(), [](const Candidate& a, const Candidate& b) {
    return a.away_m != b.away_m ? a.away_m < b.away_m : a.node < b.node;
  });
  candidates->resize(most);
}

class LoopSearch {
 public:
  LoopSearch(const Session& session, const Track& track, const LoopOptions& options)
      : session_(session),
        track_(track),
        options_(options),
        projector_(session.geometries, options.max_range_m, 0.0),
        nodes_(SpacedNodes(track, options.node_spacing_m)),
        block_(MakeBlockGraph(track, nodes_)),
        num_track_edges_(block_.graph.edges.size()),
        prepared_(nodes_.size()),
        attempts_(track.submaps.size()) {
    MeasureWays();
  }

  Loops Run(const std::function<void(std::size_t, std::size_t)>& progress) {
    progress_ = progress;
    for (const std::size_t every : kClosingRounds) Search(Round::kClosing, every);
    Search(Round::kLast, 1);
    for (const std::map<std::size_t, Attempt>& of_submap : attempts_) {
      result_.candidates_searched += static_cast<int>(of_submap.size());
    }
    return std::move(result_);
  }

 private:
  const Pose2& LocalPose(ScanId node) const {
    return track_.scans[static_cast<std::size_t>(node.value)].local_from_scan;
  }
  const Pose2& Pose(std::size_t node) const { return block_.graph.poses[block_.num_submaps + node]; }
  const Pose2& Pose(SubmapId submap) const { return block_.graph.poses[static_cast<std::size_t>(submap.value)]; }
  std::size_t NodeIndex(ScanId scan) const {
    return static_cast<std::size_t>(block_.PoseOf(scan)) - block_.num_submaps;
  }

  void MeasureWays();
  void Search(Round round, std::size_t every);
  LoopWays WaysThroughLoops() const;
  std::vector<Candidate> Candidates(const Submap& submap, const std::vector<double>& ways, Round round) const;
  bool SearchedBefore(const Submap& submap, const Candidate& candidate) const;
  void Prepare(const std::vector<std::vector<Candidate>>& candidates);
  void SearchSubmap(const Submap& submap, const std::vector<Candidate>& candidates);
  std::optional<Loop> SearchNode(const Submap& submap, const Place& place, const Candidate& candidate) const;
  std::vector<Loop> ConsistentLoops(const Submap& submap) const;
  void CloseLoops(Round round);

  const Session& session_;
  const Track& track_;
  const LoopOptions& options_;
  std::function<void(std::size_t, std::size_t)> progress_;
  ScanProjector projector_;
  std::vector<ScanId> nodes_;                             // that may be searched
  BlockGraph block_;                                      // of these nodes; poses of the current round
  std::size_t num_track_edges_;                           // of its edges; those of the loops follow
  std::vector<PlaceScan> prepared_;                       // by node; empty until it is searched
  std::vector<std::map<std::size_t, Attempt>> attempts_;  // by submap and node: the last one
  std::vector<double> way_;                               // along the track, by node
  std::vector<double> drifted_;  // the same, but blind stretches as long as what drifts as far with matches
  struct Stretch {
    double first = 0.0;
    double last = 0.0;
  };
  std::vector<Stretch> stretch_of_;  // along the track, by submap
  Loops result_;
};

// Along all nodes of the track, not only those that are searched.
void LoopSearch::MeasureWays() {
  std::vector<double> way_of_scan(track_.scans.size(), 0.0);
  std::vector<double> drifted_of_scan = way_of_scan;
  double way = 0.0;
  double drifted = 0.0;
  const TrackedScan* last = nullptr;
  for (const TrackedScan& scan : track_.scans) {
    if (!scan.is_node) continue;
    const auto index = static_cast<std::size_t>(scan.scan.value);
    const double step =
        last == nullptr ? 0.0 : Between(last->local_from_scan, scan.local_from_scan).Translation().norm();
    way_of_scan[index] = way += step;
    drifted_of_scan[index] = drifted += GoneBlind(scan) ? kBlindDrift * step : step;
    last = &scan;
  }
  for (const ScanId node : nodes_) {
    way_.push_back(way_of_scan[static_cast<std::size_t>(node.value)]);
    drifted_.push_back(drifted_of_scan[static_cast<std::size_t>(node.value)]);
  }
  for (const Submap& submap : track_.submaps) {
    stretch_of_.push_back({way_of_scan[static_cast<std::size_t>(submap.nodes.front().value)],
                           way_of_scan[static_cast<std::size_t>(submap.nodes.back().value)]});
  }
}

// In every so many submaps.
void LoopSearch::Search(Round round, std::size_t every) {
  const LoopWays ways = WaysThroughLoops();
  std::vector<std::vector<Candidate>> candidates(track_.submaps.size());
  tbb::parallel_for(std::size_t{0}, track_.submaps.size(), [&](std::size_t s) {
    if (s % every != 0) return;
    candidates[s] = Candidates(track_.submaps[s], ways.From(track_.submaps[s].id), round);
    // Narrow windows alone are left to the last round.
    const bool narrow = std::all_of(candidates[s].begin(), candidates[s].end(),
                                    [](const Candidate& candidate) { return candidate.Narrow(); });
    if (round == Round::kClosing && narrow) candidates[s].clear();
  });
  if (std::all_of(candidates.begin(), candidates.end(), [](const auto& of_submap) { return of_submap.empty(); }))
    return;
  Prepare(candidates);
  std::atomic<std::size_t> done = 0;
  std::mutex progress_mutex;
  tbb::parallel_for(std::size_t{0}, track_.submaps.size(), [&](std::size_t s) {
    SearchSubmap(track_.submaps[s], candidates[s]);
    ++done;
    const std::lock_guard lock(progress_mutex);
    if (progress_) progress_(done, track_.submaps.size());
  });
  result_.loops.clear();
  for (const Submap& submap : track_.submaps) {
    for (Loop& loop : ConsistentLoops(submap)) result_.loops.push_back(std::move(loop));
  }
  CloseLoops(round);
}

LoopWays LoopSearch::WaysThroughLoops() const {
  LoopWays ways(track_, block_, drifted_);
  for (const Loop& loop : result_.loops) {
    if (loop.accepted) ways.Close(static_cast<int>(NodeIndex(loop.constraint.scan)), loop.constraint.submap);
  }
  return ways;
}

// Nodes worth a search: far along the track, near by position as far as drift allows, and not too many of one pass.
std::vector<Candidate> LoopSearch::Candidates(const Submap& submap, const std::vector<double>& ways,
                                              Round round) const {
  std::vector<Eigen::Vector2d> places;
  const std::size_t every = 1 + submap.nodes.size() / kPlacesOfSubmap;
  for (std::size_t i = 0; i < submap.nodes.size(); i += every)
    places.push_back(Between(submap.local_from_submap, LocalPose(submap.nodes[i])).Translation());
  const Stretch& stretch = stretch_of_[static_cast<std::size_t>(submap.id.value)];
  std::vector<Candidate> candidates;
  double last_way = -std::numeric_limits<double>::max();
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (std::max(stretch.first - way_[n], way_[n] - stretch.last) < options_.min_detour_m) continue;
    if (round == Round::kClosing && way_[n] - last_way < kClosingSpacing_m) continue;
    Candidate candidate{n, Between(Pose(submap.id), Pose(n)), 0.05 + options_.drift_m_per_m * ways[n],
                        0.01 + options_.drift_rad_per_sqrt_m * std::sqrt(ways[n])};
    if (round == Round::kLast && !candidate.Narrow()) continue;
    const double reach = options_.reach_m + std::min(2.0 * candidate.sigma_m, options_.max_window_m);
    candidate.away_m = reach;
    for (const Eigen::Vector2d& place : places)
      candidate.away_m = std::min(candidate.away_m, (place - candidate.predicted.Translation()).norm());
    if (candidate.away_m >= reach) continue;
    last_way = way_[n];
    if (!SearchedBefore(submap, candidate)) candidates.push_back(candidate);
  }
  if (round == Round::kLast) KeepNearest(options_.max_nodes_per_submap, &candidates);
  return candidates;
}

// Whether the window around the prediction has been searched, as far as it matters.
bool LoopSearch::SearchedBefore(const Submap& submap, const Candidate& candidate) const {
  const auto& of_submap = attempts_[static_cast<std::size_t>(submap.id.value)];
  const auto found = of_submap.find(candidate.node);
  if (found == of_submap.end()) return false;
  const Candidate& before = found->second.candidate;
  const Pose2 moved = Between(before.predicted, candidate.predicted);
  return moved.Translation().norm() < 1.5 * before.sigma_m && std::abs(moved.theta) < 1.5 * before.sigma_rad;
}

void LoopSearch::Prepare(const std::vector<std::vector<Candidate>>& candidates) {
  std::vector<bool> wanted(nodes_.size(), false);
  for (const std::vector<Candidate>& of_submap : candidates) {
    for (const Candidate& candidate : of_submap) wanted[candidate.node] = true;
  }
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t n) {
    if (wanted[n] && prepared_[n].empty())
      prepared_[n] = PrepareForPlaces(session_, track_, nodes_[n], projector_, options_.place);
  });
}

void LoopSearch::SearchSubmap(const Submap& submap, const std::vector<Candidate>& candidates) {
  if (candidates.empty()) return;
  double widest = 0.0;
  for (const Candidate& candidate : candidates) {
    if (!candidate.Narrow()) widest = std::max(widest, 3.0 * candidate.sigma_m);
  }
  const Place place(session_, track_, submap, projector_, options_.place, std::min(widest, options_.max_window_m));
  for (const Candidate& candidate : candidates) {
    attempts_[static_cast<std::size_t>(submap.id.value)][candidate.node] = {candidate,
                                                                            SearchNode(submap, place, candidate)};
  }
}

std::optional<Loop> LoopSearch::SearchNode(const Submap& submap, const Place& place, const Candidate& candidate) const {
  const PlaceScan& scan = prepared_[candidate.node];
  const double required = options_.min_score_ratio * place.own_score();
  Pose2 start = candidate.predicted;
  if (!candidate.Narrow()) {
    const SearchWindow window{.half_width_m = std::min(3.0 * candidate.sigma_m, options_.max_window_m),
                              .half_angle_rad = std::min(3.0 * candidate.sigma_rad, options_.max_window_rad),
                              .min_score = place.LeastScore(options_.min_overlap, required)};
    const std::optional<SearchResult> found = place.Search(scan, candidate.predicted, window);
    if (!found) return std::nullopt;
    start = found->map_from_scan;
  }
  const Eigen::Vector3d sigmas(candidate.sigma_m, candidate.sigma_m, candidate.sigma_rad);
  const MatchResult match = place.Match(scan, start, candidate.predicted, sigmas.cwiseAbs2().asDiagonal());
  if (!match.usable) return std::nullopt;
  const PlaceOverlap overlap = place.Overlap(scan, match.map_from_scan);
  if (overlap.share < options_.min_overlap || overlap.occupancy < required) return std::nullopt;
  Loop loop;
  loop.constraint = {submap.id, nodes_[candidate.node], match.map_from_scan, match.covariance};
  loop.constraint.covariance.diagonal() += Eigen::Vector3d(4e-4, 4e-4, 1e-5);  // the submap's own bending
  loop.score = overlap.occupancy;
  return loop;
}

std::vector<Loop> LoopSearch::ConsistentLoops(const Submap& submap) const {
  std::vector<Loop> loops;
  std::vector<double> ways;
  std::vector<Pose2> local_poses;
  for (const auto& [node, attempt] : attempts_[static_cast<std::size_t>(submap.id.value)]) {
    if (!attempt.loop) continue;
    loops.push_back(*attempt.loop);
    ways.push_back(drifted_[node]);
    local_poses.push_back(LocalPose(nodes_[node]));
  }
  KeepMutuallyConsistent(ways, local_poses, {options_.drift_m_per_m, options_.drift_rad_per_sqrt_m}, &loops);
  return loops;
}

// Solves with the accepted loops under a robust loss and drops those that the whole graph contradicts.
void LoopSearch::CloseLoops(Round round) {
  block_.graph.edges.resize(num_track_edges_);
  for (const Loop& loop : result_.loops) {
    if (loop.accepted) AddLoop(loop.constraint, &block_);
  }
  Solve(&block_.graph, {.negligible_cost = kNegligibleCost, .chordal_start = round == Round::kClosing});
  const auto track_end = block_.graph.edges.begin() + static_cast<std::ptrdiff_t>(num_track_edges_);
  std::vector<PoseEdge> kept(block_.graph.edges.begin(), track_end);
  std::size_t next = num_track_edges_;
  for (Loop& loop : result_.loops) {
    if (!loop.accepted) continue;
    const PoseEdge& edge = block_.graph.edges[next++];
    if (SquaredNormalisedResidual(edge, block_.graph.poses) > kFarthestLoop) {
      loop.accepted = false;
      loop.reason = "contradicts the rest of the block";
    } else {
      kept.push_back(edge);
    }
  }
  if (round == Round::kLast || kept.size() == block_.graph.edges.size()) return;
  block_.graph.edges = std::move(kept);
  Solve(&block_.graph, {.negligible_cost = kNegligibleCost});
}

}  // namespace

Loops FindLoops(const Session& session, const Track& track, const LoopOptions& options,
                const std::function<void(std::size_t, std::size_t)>& progress) {
  if (track.submaps.empty()) return {};
  return LoopSearch(session, track, options).Run(progress);
}

}  // namespace survey
