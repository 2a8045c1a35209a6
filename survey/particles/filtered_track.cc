// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/filtered_track.h"

#include "survey/particles/traverse.h"
#include "survey/submaps/marks.h"

namespace survey {
namespace {

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

}  // namespace

Track FollowBestTrajectory(const Session& session, const Track& local, const TrajectoryTree& tree,
                           const Answers& answers, const ParticleFilterOptions& options) {
  Track track = local;
  std::vector<Pose2> trajectory = BestTrajectory(tree);
  CloseTraverses(local, tree, answers, options, &trajectory);
  for (std::size_t k = 0; k < tree.size(); ++k) BendBetween(local, tree, trajectory, k, &track);
  for (TrackedScan& scan : track.scans) {
    const double turn = scan.local_from_scan.theta - Tracked(local, scan.scan).theta;
    scan.covariance = RotatedCovariance(scan.covariance, turn);
  }
  MoveSubmaps(local, &track);
  track.marks = TrackMarks(session, track.scans);
  return track;
}

}  // namespace survey
