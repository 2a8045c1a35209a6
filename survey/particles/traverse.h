// SPDX-License-Identifier: Apache-2.0
//
// The way to a corrected pose. A correction moves the particles from its scan on ([AS] section IV-A) and leaves the way
// there as it was. Offline the way is closed as a traverse: what the correction shows is laid on the updates since the
// last pose that a person gave or confirmed, by the variances of their motions; that of blind stretches takes the most.
#pragma once

#include <vector>

#include "survey/particles/particle_filter.h"

namespace survey {

// `trajectory`: a pose at each update of the tree, local_from_scan; corrected poses stay where they are.
void CloseTraverses(const Track& track, const TrajectoryTree& tree, const Answers& answers,
                    const ParticleFilterOptions& options, std::vector<Pose2>* trajectory);

}  // namespace survey
