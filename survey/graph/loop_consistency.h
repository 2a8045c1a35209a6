// SPDX-License-Identifier: Apache-2.0
//
// Which loops of a submap tell the same story: perceptual aliasing (alike corridors, symmetric rooms) yields matches
// that fit the map but not each other.
#pragma once

#include <functional>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/submaps/track.h"

namespace survey {

// Of a squared normalised residual with three degrees of freedom, 99.9 %.
inline constexpr double kChiSquare3 = 16.27;
// Of a loop that stays.
inline constexpr double kFarthestLoop = 3.0 * kChiSquare3;

// How far the track may have drifted over a way: sigmas per metre and per root of a metre.
struct DriftRates {
  double m_per_m = 0.01;
  double rad_per_sqrt_m = 0.004;
};

// Of one submap's loops, in the order of their nodes, rejects those that most of their neighbours contradict, and those
// that no neighbour confirms. `way`: along the track, by loop, m; `local_from_scan`: of the loops' nodes in the track.
void KeepMutuallyConsistent(const std::vector<double>& way, const std::vector<Pose2>& local_from_scan,
                            const DriftRates& drift, std::vector<Loop>* loops);

}  // namespace survey
