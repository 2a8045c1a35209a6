// SPDX-License-Identifier: Apache-2.0
//
// The track of a block along the best trajectory of its particle filter.
#pragma once

#include <vector>

#include "survey/particles/particle_filter.h"

namespace survey {

// `local` is the track of the scan matcher. Between two updates its motion is bent to fit both; submaps move with their
// first nodes; constraints and marks are measured anew along the trajectory. The ways to poses that a person corrected
// are closed (traverse.h).
Track FollowBestTrajectory(const Session& session, const Track& local, const TrajectoryTree& tree,
                           const Answers& answers = {}, const ParticleFilterOptions& options = {});

}  // namespace survey
