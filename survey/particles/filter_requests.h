// SPDX-License-Identifier: Apache-2.0
//
// Where a particle filter doubts: questions for a person about its track.
#pragma once

#include "survey/particles/trajectory_tree.h"
#include "survey/submaps/track.h"

namespace survey {

// Doubts that follow each other within `updates_together` make one request; 0: every drop is asked, as in [AS].
// Adds requests to the track of the filter's best trajectory, `local` being that of the scan matcher:
// "neff": one for each stretch in which the effective sample size dropped again and again, at its worst place;
// "several_modes": where the particles lie in groups apart from each other, with the poses of the groups;
// "engines_disagree": where filter and scan matcher moved otherwise over the last 10 m, with the pose of the matcher;
// "odometry_only": where matches begin again behind a stretch without; "break": where no particle had a weight.
void AddFilterRequests(const Track& local, const TrajectoryTree& tree, int updates_together, Track* track);

}  // namespace survey
