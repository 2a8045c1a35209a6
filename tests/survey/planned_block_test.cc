// SPDX-License-Identifier: Apache-2.0
//
// What is planned on a floor plan against what surveys of the same block then find, seed by seed.
#include "survey/simulation/planned_block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/graph/block_adjustment.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/loop_search.h"
#include "survey/graph/variance_components.h"
#include "survey/planning/control_plan.h"
#include "survey/simulation/survey_work.h"
#include "survey/submaps/tracker.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

// A hall with four points, driven round twice; the laser is coarse and slow, so that a survey takes a second.
Scenario Hall(std::uint64_t seed) {
  Scenario scenario = test_support::RoomScenario();
  scenario.seed = seed;
  scenario.lidar.rate_hz = 10.0;
  scenario.lidar.num_beams = 271;
  scenario.points = {{.name = "A", .position = {12.0, 4.0}},
                     {.name = "B", .position = {18.0, 8.0}},
                     {.name = "C", .position = {12.0, 12.0}},
                     {.name = "D", .position = {4.0, 8.0}}};
  const std::vector<Waypoint> lap = {{{12.0, 4.0}, "A"},  {{18.0, 4.0}, ""}, {{18.0, 8.0}, "B"}, {{18.0, 12.0}, ""},
                                     {{12.0, 12.0}, "C"}, {{4.0, 12.0}, ""}, {{4.0, 8.0}, "D"},  {{4.0, 4.0}, ""}};
  std::vector<Waypoint>& way = scenario.blocks[0].waypoints;
  way = {{{5.0, 4.0}, ""}};
  way.insert(way.end(), lap.begin(), lap.end());
  for (Waypoint point : lap) way.push_back({point.position, ""});
  return scenario;
}

struct Drive {
  explicit Drive(const Scenario& hall)
      : scenario(hall), building(BuildFloorPlan(scenario)), route(PlanRoute(scenario, scenario.blocks[0], building)) {}
  const Scenario scenario;
  const RayCaster building;
  const RoutePlan route;
};

// Sum of the squared errors of the nodes, and how many there are.
void AddErrors(const Drive& drive, double* squares, int* count) {
  const Session session = SimulateSession(drive.scenario, drive.scenario.blocks[0], drive.building, drive.route);
  const Track track = TrackBlock(session, {});
  ControlNetwork control{.points = SurveyControl(drive.scenario)};
  const BlockAdjustment adjusted =
      AdjustBlock(track, FindLoops(session, track, {}), control, ClockStamps(StampsOfScans(session)), {});
  ASSERT_TRUE(adjusted.usable) << adjusted.message;
  for (const SolvedScan& scan : adjusted.solution.scans) {
    if (!scan.is_node) continue;
    const StampNs stamp = session.scans[static_cast<std::size_t>(scan.scan.value)].stamp_ns;
    const Eigen::Vector2d truth =
        drive.scenario.SiteOf(drive.route.trajectory->PlanarPlanFromLidar(Seconds(stamp)).Translation());
    *squares += (scan.site_from_scan.Translation() - truth).squaredNorm();
    ++*count;
  }
}

TEST(PlannedBlock, PredictedSigmaAgreesWithTheErrorsOfSurveys) {
  const Drive planned(Hall(1000));
  ASSERT_TRUE(planned.route.trajectory) << planned.route.problem;
  const PlannedBlock block =
      WalkPlannedBlock(planned.scenario, planned.scenario.blocks[0], planned.building, planned.route);
  BlockGraph network = MakeBlockGraph(block.track, block.loops);
  ASSERT_TRUE(SolveFree({}, &network.graph).summary.usable);
  FreezeRobustWeights(&network.graph);
  std::vector<int> taken;
  for (const TrackedMark& mark : block.track.marks) taken.push_back(network.PoseOf(mark.scan));
  ASSERT_EQ(taken.size(), 4U);
  const auto plan = PlanControl(network.graph, static_cast<int>(network.num_submaps), taken,
                                {.control_sigma_m = 0.003, .mark_sigma_m = 0.005, .max_points = 4});
  ASSERT_TRUE(plan);
  double squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) AddErrors(Drive(Hall(seed)), &squares, &count);
  const double actual = std::sqrt(squares / count);
  EXPECT_NEAR(plan->steps.back().rms, actual, 0.25 * actual);
  // Where the plan says it lies.
  EXPECT_LT((block.site_from_local * plan->steps[0].place - planned.scenario.SiteOf({12.0, 4.0})).norm(), 0.05);
}

}  // namespace
}  // namespace survey
