// SPDX-License-Identifier: Apache-2.0
//
// Occupations of points as the trajectory sees them, [CN] section 2.3: the lidar centre (plus lever arm) stood on the
// point.
#pragma once

#include <vector>

#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

// True for the scans that carry a mark: the one nearest to the middle of each occupation. They must become nodes.
std::vector<bool> ScansThatCarryMarks(const Session& session);

// The marked places in the frames of their nodes: the mean over all matched scans of the occupation, so that the noise
// of one match averages out. Covariance: centring plus the scatter of the mean. In order of start.
std::vector<TrackedMark> TrackMarks(const Session& session, const std::vector<TrackedScan>& scans);

}  // namespace survey
