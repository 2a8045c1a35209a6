// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/planned_block.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "survey/geometry/rigid_fit.h"
#include "survey/graph/loop_search.h"
#include "survey/submaps/tracker.h"

namespace survey {
namespace {

StampNs ToTheMillisecond(double time_s) { return std::llround(time_s * 1e3) * 1000000; }

// The nodes of the track onto the way that was planned.
Pose2 SiteFromLocal(const Scenario& scenario, const Session& session, const Track& track,
                    const Trajectory& trajectory) {
  std::vector<Eigen::Vector2d> tracked, planned;
  for (std::size_t i = 0; i < track.scans.size(); ++i) {
    if (!track.scans[i].is_node) continue;
    tracked.push_back(track.scans[i].local_from_scan.Translation());
    planned.push_back(trajectory.PlanarPlanFromLidar(Seconds(session.scans[i].stamp_ns)).Translation());
  }
  const std::optional<RigidFit> fit = FitRigid(tracked, planned);
  const Pose2 plan_from_local = fit ? fit->target_from_source : Pose2{};
  return Pose2{scenario.origin_in_site.x(), scenario.origin_in_site.y(), 0.0} * plan_from_local;
}

}  // namespace

std::vector<Scan> SimulateScans(const SimulatedLidar& lidar, const std::function<void(std::int64_t)>& done) {
  std::vector<Scan> scans(static_cast<std::size_t>(lidar.num_scans()));
  tbb::parallel_for(
      tbb::blocked_range<std::int64_t>(0, lidar.num_scans(), 64), [&](const tbb::blocked_range<std::int64_t>& range) {
        for (std::int64_t i = range.begin(); i < range.end(); ++i)
          scans[static_cast<std::size_t>(i)] = {.stamp_ns = lidar.StampOf(i), .ranges_m = lidar.Ranges(i)};
        if (done) done(range.end() - range.begin());
      });
  return scans;
}

std::vector<Mark> MarksOfRoute(const RoutePlan& route) {
  std::vector<Mark> marks;
  for (const Stop& stop : route.stops)
    marks.push_back({stop.point, ToTheMillisecond(stop.start_s), ToTheMillisecond(stop.end_s)});
  return marks;
}

Session SimulateSession(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                        const RoutePlan& route) {
  Session session;
  session.setup.body_from_lidar = scenario.cart.body_from_lidar;
  session.geometries.push_back(GeometryOf(scenario.lidar));
  session.scans = SimulateScans(SimulatedLidar(scenario, block, building, *route.trajectory));
  session.imu = SimulateImu(scenario, block, *route.trajectory);
  session.odometry = SimulateOdometry(scenario, block, *route.trajectory);
  session.marks = MarksOfRoute(route);
  return session;
}

PlannedBlock WalkPlannedBlock(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                              const RoutePlan& route) {
  const Session session = SimulateSession(scenario, block, building, route);
  PlannedBlock planned;
  planned.track = TrackBlock(session, {});
  planned.loops = FindLoops(session, planned.track, {});
  planned.site_from_local = SiteFromLocal(scenario, session, planned.track, *route.trajectory);
  return planned;
}

}  // namespace survey
