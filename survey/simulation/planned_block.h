// SPDX-License-Identifier: Apache-2.0
//
// A block before anybody has walked it: the cart of the scenario drives the planned route through the floor plan, and
// the SLAM runs on what its sensors would read. So whatever weakens a track on the site (long halls, glass, people,
// distances beyond the reach of the laser) weakens the planned one.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "survey/sensors/session.h"
#include "survey/simulation/ray_caster.h"
#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "survey/simulation/scenario.h"
#include "survey/submaps/track.h"

namespace survey {

// All scans of a block, made in parallel. `done` is called from any thread with the number of scans that were added.
std::vector<Scan> SimulateScans(const SimulatedLidar& lidar, const std::function<void(std::int64_t)>& done = {});

// The route's stops as they are written down in the field: to the millisecond.
std::vector<Mark> MarksOfRoute(const RoutePlan& route);

// The field data of a block as `ingest` would read them. `route` can be driven.
Session SimulateSession(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                        const RoutePlan& route);

struct PlannedBlock {
  Track track;
  Loops loops;
  Pose2 site_from_local;  // best fit of the track on the planned way
};

// Track and loops with the defaults of their stages.
PlannedBlock WalkPlannedBlock(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                              const RoutePlan& route);

}  // namespace survey
