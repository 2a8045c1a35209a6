// SPDX-License-Identifier: Apache-2.0
//
// What is made of the stretches in which no scan match held the track: the smoothed inertial poses are put in, breaks
// of the track are told, and a summary says by what the block was navigated and for how long.
#pragma once

#include <vector>

#include "survey/inertial/navigator.h"
#include "survey/submaps/track.h"

namespace survey {

// Stretches without a match between two that have one, navigated by the IMU throughout: every pose takes the smoother's
// correction, and the constraints of the nodes there with it. Corrections in order of their stamps.
void BridgeUnmatched(const Session& session, const std::vector<SmoothedCorrection>& corrections, Track* track);

// Requests for stretches without a match. They are breaks (the map behind may be displaced) where only constant
// velocity carried on for more than 0.3 s, or the IMU alone for more than 5 s, and where the IMU says that the platform
// was tilted or the matches are false. Where scans are missing for more than 2 s likewise: a break with nothing to go
// by or with the IMU alone for more than 5 s.
void AddRequests(const Session& session, const InertialSummary& inertial, Track* track);

NavigationSummary SummarizeNavigation(const Session& session, const InertialSummary& inertial, const Track& track);

}  // namespace survey
