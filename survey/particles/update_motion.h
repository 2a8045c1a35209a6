// SPDX-License-Identifier: Apache-2.0
//
// How the platform moved from one update of the particle filter to the next, as the track of the scan matcher has it.
#pragma once

#include <Eigen/Core>

#include "survey/particles/particle_filter.h"

namespace survey {

struct UpdateMotion {
  Pose2 motion;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // in the frame of the former update; m, rad
};

// Scans of rejected stretches count as not matched.
UpdateMotion MotionBetween(const Track& track, ScanId from, ScanId to, const Answers& answers,
                           const ParticleFilterOptions& options);

}  // namespace survey
