// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/filtered_track.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "survey/submaps/marks.h"

namespace survey {
namespace {

constexpr int kUpdatesBetweenStretches = 5;

Pose2 Tracked(const Track& track, ScanId scan) {
  return track.scans[static_cast<std::size_t>(scan.value)].local_from_scan;
}

// The track between updates k and k + 1, bent to begin and end where the trajectory does.
void BendBetween(const Track& local, const TrajectoryTree& tree, const std::vector<Pose2>& trajectory, std::size_t k,
                 Track* track) {
  const int begin = tree[k].scan.value;
  const bool last = k + 1 == tree.size();
  const int end = last ? static_cast<int>(local.scans.size()) : tree[k + 1].scan.value;
  for (int i = begin; i < end; ++i) {
    const Pose2& tracked = Tracked(local, {i});
    Pose2 pose = trajectory[k] * Between(Tracked(local, tree[k].scan), tracked);
    if (!last) {
      const Pose2 from_next = trajectory[k + 1] * Between(Tracked(local, tree[k + 1].scan), tracked);
      pose = Interpolate(pose, from_next, static_cast<double>(i - begin) / static_cast<double>(end - begin));
    }
    track->scans[static_cast<std::size_t>(i)].local_from_scan = pose;
  }
}

void MoveSubmaps(const Track& local, Track* track) {
  for (Submap& submap : track->submaps) {
    const ScanId first = submap.nodes.front();
    submap.local_from_submap = Tracked(*track, first) * Between(Tracked(local, first), submap.local_from_submap);
  }
  for (SubmapConstraint& constraint : track->constraints) {
    const auto submap = static_cast<std::size_t>(constraint.submap.value);
    const Pose2& local_from_submap = track->submaps[submap].local_from_submap;
    constraint.submap_from_scan = Between(local_from_submap, Tracked(*track, constraint.scan));
    constraint.covariance = RotatedCovariance(
        constraint.covariance, local.submaps[submap].local_from_submap.theta - local_from_submap.theta +
                                   Tracked(*track, constraint.scan).theta - Tracked(local, constraint.scan).theta);
  }
}

double SpreadOf(const FilterUpdate& update) { return std::hypot(update.spread.x, update.spread.y); }

ReviewRequest RequestOf(const FilterUpdate& worst, int drops) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "effective sample size %.1f of %zu, particles spread over %.3f m, %.2f degrees (1 sigma); %d drops in a row",
      worst.effective_size, worst.poses.size(), SpreadOf(worst), worst.spread.theta * 57.29577951308232, drops);
  return {worst.scan, "neff", SpreadOf(worst), text};
}

// Scans without a match from update k - 1 to k, when k itself has one.
int UnmatchedBefore(const TrajectoryTree& tree, const Track& track, std::size_t k) {
  const auto scan = [&](std::size_t update) { return static_cast<std::size_t>(tree[update].scan.value); };
  if (k == 0 || !track.scans[scan(k)].matched) return 0;
  int unmatched = 0;
  for (std::size_t i = scan(k - 1) + 1; i < scan(k); ++i) unmatched += track.scans[i].matched ? 0 : 1;
  return unmatched;
}

}  // namespace

Track FollowBestTrajectory(const Session& session, const Track& local, const TrajectoryTree& tree) {
  Track track = local;
  const std::vector<Pose2> trajectory = BestTrajectory(tree);
  for (std::size_t k = 0; k < tree.size(); ++k) BendBetween(local, tree, trajectory, k, &track);
  for (TrackedScan& scan : track.scans) {
    const double turn = scan.local_from_scan.theta - Tracked(local, scan.scan).theta;
    scan.covariance = RotatedCovariance(scan.covariance, turn);
  }
  MoveSubmaps(local, &track);
  track.marks = TrackMarks(session, track.scans);
  return track;
}

void AddFilterRequests(const TrajectoryTree& tree, Track* track) {
  std::size_t last = 0;
  std::size_t worst = 0;
  int drops = 0;
  const auto close = [&] {
    if (drops > 0) track->requests.push_back(RequestOf(tree[worst], drops));
    drops = 0;
  };
  for (std::size_t k = 0; k < tree.size(); ++k) {
    if (tree[k].lost)
      track->requests.push_back(
          {tree[k].scan, "break", 1.0, "no particle explains the scan; all go on with equal weights"});
    if (const int unmatched = UnmatchedBefore(tree, *track, k); unmatched > 0)
      track->requests.push_back(
          {tree[k].scan, "odometry_only", SpreadOf(tree[k]),
           "the first match behind a stretch without; " + std::to_string(unmatched) + " scans since the last update"});
    if (!tree[k].resampled) continue;
    if (drops > 0 && k - last > kUpdatesBetweenStretches) close();
    if (drops == 0 || SpreadOf(tree[k]) > SpreadOf(tree[worst])) worst = k;
    last = k;
    ++drops;
  }
  close();
  std::stable_sort(track->requests.begin(), track->requests.end(),
                   [](const ReviewRequest& a, const ReviewRequest& b) { return a.scan < b.scan; });
}

}  // namespace survey
