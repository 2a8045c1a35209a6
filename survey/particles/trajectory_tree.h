// SPDX-License-Identifier: Apache-2.0
//
// The trajectories of all particles of a filter as one tree: each update holds a pose per particle and the particle of
// the update before that it comes from. Maps can be drawn anew from it. Poses in the block's local frame.
#pragma once

#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/submaps/track.h"

namespace survey {

struct FilterUpdate {
  ScanId scan;
  std::vector<Pose2> poses;         // by particle, after resampling: local_from_scan
  std::vector<int> parents;         // by particle: index in the update before
  std::vector<double> log_weights;  // by particle, normalised, after resampling
  std::vector<double> evidence;     // by particle: sum of the log weights of its whole trajectory
  double effective_size = 0.0;      // before resampling
  bool resampled = false;
  bool lost = false;  // no particle had a weight
  Pose2 spread;       // of the particles before resampling, 1 sigma: m, m, rad
};

using TrajectoryTree = std::vector<FilterUpdate>;

// Pose of a particle of the last update at an earlier one.
Pose2 PoseOfAncestor(const TrajectoryTree& tree, std::size_t particle, std::size_t update);

// The particle whose whole trajectory explains the scans best, at each update.
std::vector<Pose2> BestTrajectory(const TrajectoryTree& tree);

}  // namespace survey
