// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_matches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "survey/graph/loop_consistency.h"

namespace survey {
namespace {

constexpr std::size_t kPlacesOfSubmap = 24;  // its nodes that tell where it lies
// What a match takes from its start: next to nothing, but for directions that it does not see.
constexpr double kStartSigma_m = 0.2;
constexpr double kStartSigma_rad = 0.03;

// Pose of a scan of the second block, and how far along its track.
struct Candidate {
  ScanId scan;
  double way = 0.0;
};

class Matcher {
 public:
  Matcher(const MatchedBlock& first, const MatchedBlock& second, const BlockMatchOptions& options)
      : first_(first),
        second_(second),
        options_(options),
        projector_of_first_(first.session->geometries, options.max_range_m, 0.0),
        projector_of_second_(second.session->geometries, options.max_range_m, 0.0) {}

  std::vector<Loop> Run() {
    const std::vector<Submap>& submaps = first_.track->submaps;
    std::vector<std::vector<Candidate>> candidates(submaps.size());
    std::vector<bool> wanted(second_.track->scans.size(), false);
    const std::vector<Candidate> nodes = SpacedCandidates();
    for (std::size_t s = 0; s < submaps.size(); ++s) {
      candidates[s] = Near(submaps[s], nodes);
      for (const Candidate& candidate : candidates[s]) wanted[IndexOf(candidate.scan)] = true;
    }
    Prepare(wanted);
    std::vector<std::vector<Loop>> of_submap(submaps.size());
    tbb::parallel_for(std::size_t{0}, submaps.size(),
                      [&](std::size_t s) { of_submap[s] = MatchSubmap(submaps[s], candidates[s]); });
    std::vector<Loop> matches;
    for (std::vector<Loop>& loops : of_submap) matches.insert(matches.end(), loops.begin(), loops.end());
    return matches;
  }

 private:
  const Pose2& PoseInSite(ScanId scan) const { return second_.track->scans[IndexOf(scan)].local_from_scan; }

  std::vector<Candidate> SpacedCandidates() const {
    std::vector<Candidate> nodes;
    double way = 0.0;
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    for (const ScanId scan : SpacedNodes(*second_.track, options_.node_spacing_m)) {
      const Eigen::Vector2d place = PoseInSite(scan).Translation();
      if (!nodes.empty()) way += (place - last).norm();
      last = place;
      nodes.push_back({scan, way});
    }
    return nodes;
  }

  std::vector<Candidate> Near(const Submap& submap, const std::vector<Candidate>& nodes) const {
    std::vector<Eigen::Vector2d> places;
    const std::size_t every = 1 + submap.nodes.size() / kPlacesOfSubmap;
    for (std::size_t i = 0; i < submap.nodes.size(); i += every)
      places.push_back(first_.track->scans[IndexOf(submap.nodes[i])].local_from_scan.Translation());
    std::vector<Candidate> near;
    for (const Candidate& candidate : nodes) {
      const Eigen::Vector2d place = PoseInSite(candidate.scan).Translation();
      if (std::any_of(places.begin(), places.end(),
                      [&](const Eigen::Vector2d& other) { return (place - other).norm() < options_.reach_m; }))
        near.push_back(candidate);
    }
    return near;
  }

  void Prepare(const std::vector<bool>& wanted) {
    prepared_.resize(wanted.size());
    tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t scan) {
      if (!wanted[scan]) return;
      prepared_[scan] = PrepareForPlaces(*second_.session, *second_.track, ScanId{static_cast<int>(scan)},
                                         projector_of_second_, options_.place);
    });
  }

  std::vector<Loop> MatchSubmap(const Submap& submap, const std::vector<Candidate>& candidates) const {
    if (candidates.empty()) return {};
    const Place place(*first_.session, *first_.track, submap, projector_of_first_, options_.place, 0.0);
    std::vector<Loop> loops;
    std::vector<double> ways;
    std::vector<Pose2> poses;
    for (const Candidate& candidate : candidates) {
      const std::optional<Loop> loop = MatchScanTo(submap, place, candidate.scan);
      if (!loop) continue;
      loops.push_back(*loop);
      ways.push_back(candidate.way);
      poses.push_back(PoseInSite(candidate.scan));
    }
    KeepMutuallyConsistent(ways, poses, {}, &loops);
    return loops;
  }

  std::optional<Loop> MatchScanTo(const Submap& submap, const Place& place, ScanId scan) const {
    const PlaceScan& points = prepared_[IndexOf(scan)];
    const Pose2 predicted = Between(submap.local_from_submap, PoseInSite(scan));
    const Eigen::Vector3d sigmas(kStartSigma_m, kStartSigma_m, kStartSigma_rad);
    const MatchResult match = place.Match(points, predicted, predicted, sigmas.cwiseAbs2().asDiagonal());
    if (!match.usable) return std::nullopt;
    const PlaceOverlap overlap = place.Overlap(points, match.map_from_scan);
    if (overlap.share < options_.min_overlap || overlap.occupancy < options_.min_score_ratio * place.own_score())
      return std::nullopt;
    return Loop{.constraint = {submap.id, scan, match.map_from_scan, match.covariance}, .score = overlap.occupancy};
  }

  const MatchedBlock& first_;
  const MatchedBlock& second_;
  const BlockMatchOptions& options_;
  ScanProjector projector_of_first_;
  ScanProjector projector_of_second_;
  std::vector<PlaceScan> prepared_;  // by scan of the second block
};

}  // namespace

Track TrackInSite(const Track& track, const Solution& solution) {
  Track in_site = track;
  for (std::size_t i = 0; i < in_site.scans.size(); ++i)
    in_site.scans[i].local_from_scan = solution.scans[i].site_from_scan;
  for (std::size_t i = 0; i < in_site.submaps.size(); ++i)
    in_site.submaps[i].local_from_submap = solution.submaps[i].site_from_submap;
  return in_site;
}

std::vector<Loop> MatchBlocks(const MatchedBlock& first, const MatchedBlock& second, const BlockMatchOptions& options) {
  return Matcher(first, second, options).Run();
}

}  // namespace survey
