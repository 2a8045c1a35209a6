// SPDX-License-Identifier: Apache-2.0
//
// plumbline-plan: predicts a block's accuracy against number and place of its control points, and says where the next
// points serve best: from a first walk, or from a floor plan with a route before anybody has been there.
#include <cstdio>

#include "formats/artefacts.h"
#include "formats/plan_file.h"
#include "formats/scenario_route.h"
#include "formats/scenario_toml.h"
#include "pipeline/stage.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/variance_components.h"
#include "survey/planning/control_plan.h"
#include "survey/simulation/planned_block.h"

namespace {

namespace fs = std::filesystem;

struct PlanFiles {
  fs::path track;
  fs::path loops;
  fs::path solution;
  fs::path floor_plan;
  std::string block;
  fs::path output;
  fs::path picture;
};

// A control point that is there already, and the pose that saw it first.
struct ExistingPoint {
  int pose = 0;
  std::string name;
};

// What is planned on: a block without control, and how it lies in the site.
struct PlannedNetwork {
  survey::BlockGraph block;
  std::vector<ExistingPoint> existing;
  survey::Pose2 site_from_local;
  bool tied = false;
  std::string crs;
  std::vector<formats::PlanReport::Wall> walls;
};

void AddExisting(const std::string& name, survey::ScanId scan, PlannedNetwork* network) {
  const bool known = std::any_of(network->existing.begin(), network->existing.end(),
                                 [&](const ExistingPoint& point) { return point.name == name; });
  if (!known) network->existing.push_back({network->block.PoseOf(scan), name});
}

PlannedNetwork OfFirstWalk(const PlanFiles& files) {
  const survey::Track track = formats::ReadTrack(files.track);
  PlannedNetwork network{.block = survey::MakeBlockGraph(track, formats::ReadLoops(files.loops))};
  if (files.solution.empty()) return network;
  const survey::Solution solution = formats::ReadSolution(files.solution);
  if (solution.scans.size() != track.scans.size())
    throw formats::DataError(files.solution.string() + ": does not belong to " + files.track.string());
  for (const survey::SolvedMark& mark : solution.marks) {
    if (mark.used) AddExisting(mark.point, mark.scan, &network);
  }
  network.site_from_local = solution.site_from_local;
  network.tied = solution.tied;
  network.crs = solution.frame.crs;
  return network;
}

std::vector<formats::PlanReport::Wall> WallsOf(const survey::Scenario& scenario, const survey::FloorPlan& plan) {
  std::vector<formats::PlanReport::Wall> walls;
  for (const survey::Face& face : plan.solid_faces) walls.push_back({scenario.SiteOf(face.a), scenario.SiteOf(face.b)});
  for (const survey::Pane& pane : plan.panes) walls.push_back({scenario.SiteOf(pane.a), scenario.SiteOf(pane.b)});
  return walls;
}

bool IsControl(const survey::Scenario& scenario, const std::string& name) {
  return std::any_of(scenario.points.begin(), scenario.points.end(), [&](const survey::LandmarkPoint& point) {
    return point.name == name && point.role == survey::PointRole::kControl;
  });
}

PlannedNetwork OfFloorPlan(const PlanFiles& files) {
  const survey::Scenario scenario = formats::ReadScenario(files.floor_plan);
  const survey::BlockRoute& block = formats::BlockOfScenario(files.floor_plan, scenario, files.block);
  const survey::FloorPlan plan = survey::BuildFloorPlan(scenario);
  const survey::RayCaster building(plan);
  const survey::RoutePlan route = formats::DrivableRoute(files.floor_plan, scenario, block, building);
  const survey::PlannedBlock planned = survey::WalkPlannedBlock(scenario, block, building, route);
  PlannedNetwork network{.block = survey::MakeBlockGraph(planned.track, planned.loops)};
  for (const survey::TrackedMark& mark : planned.track.marks) {
    if (IsControl(scenario, mark.point)) AddExisting(mark.point, mark.scan, &network);
  }
  network.site_from_local = planned.site_from_local;
  network.tied = true;
  network.crs = scenario.crs;
  network.walls = WallsOf(scenario, plan);
  return network;
}

// From one of both sources, solved, its loops at their final weights.
PlannedNetwork SolvedNetwork(const PlanFiles& files) {
  const bool walked = !files.track.empty() && !files.loops.empty();
  const bool drawn = !files.floor_plan.empty() && !files.block.empty();
  const bool both =
      !(files.track.empty() && files.loops.empty() && files.solution.empty()) && !files.floor_plan.empty();
  if (walked == drawn || both)
    throw formats::UsageError("give --track and --loops of a first walk, or --floor-plan and --block");
  PlannedNetwork network = drawn ? OfFloorPlan(files) : OfFirstWalk(files);
  const survey::PoseGraphSummary summary = survey::SolveFree({}, &network.block.graph).summary;
  if (!summary.usable)
    throw formats::DataError((drawn ? files.floor_plan : files.track).string() + ": " + summary.message);
  survey::FreezeRobustWeights(&network.block.graph);
  return network;
}

formats::PlanReport ReportOf(const survey::ControlPlan& plan, const PlannedNetwork& network) {
  formats::PlanReport report{.tied = network.tied, .crs = network.crs, .walls = network.walls};
  const std::size_t num_existing = network.existing.size();
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    const survey::PlanStep& step = plan.steps[i];
    const bool old = i < num_existing;
    report.points.push_back({old ? network.existing[i].name : "new " + std::to_string(i + 1 - num_existing), old,
                             network.site_from_local * step.place, step.rms, step.max});
  }
  for (std::size_t i = 0; i < plan.path.size(); ++i) {
    const survey::Pose2& pose = network.block.graph.poses[static_cast<std::size_t>(plan.path[i])];
    report.path.push_back({network.site_from_local * pose.Translation(), plan.sigma_of_path[i]});
  }
  return report;
}

std::string Summary(const formats::PlanReport& report) {
  std::string text = "predicted rms of the way:";
  for (std::size_t i = 1; i < report.points.size(); ++i) {
    char step[64];
    std::snprintf(step, sizeof step, "%s %zu points %.1f mm", i == 1 ? "" : ",", i + 1, 1000.0 * report.points[i].rms);
    text += step;
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("plan", "Predict accuracy against number and place of control points; choose the next ones.",
                        "plumbline plan --floor-plan garage.toml --block B1 --output plan.json --picture plan.svg");
  PlanFiles files;
  survey::ControlPlanOptions options;
  bool keep_points = true;
  stage.OptionalInput("track", &files.track, "track of a first walk through the block");
  stage.OptionalInput("loops", &files.loops, "its loops");
  stage.OptionalInput("solution", &files.solution, "its solution: site coordinates and control points");
  stage.OptionalInput("floor-plan", &files.floor_plan,
                      "instead of a walk: building, rig and routes, as `simulate` reads them (TOML)");
  stage.Option("block", &files.block, "the block of the floor plan whose route is driven");
  stage.Output("output", &files.output, "plan.json to write");
  stage.OptionalOutput("picture", &files.picture, "SVG to write: curve and map");
  stage.Option("keep-points", &keep_points, "control points that are there come first; false: all are chosen anew");
  stage.Option("max-points", &options.max_points, "control points in all", {.min = 2, .max = 100});
  stage.Option("candidate-spacing-m", &options.candidate_spacing_m, "path between places where a point could be (m)",
               {.min = 0.5, .max = 100.0});
  stage.Option("control-sigma-m", &options.control_sigma_m, "of a control point, 1 sigma per axis (m)",
               {.min = 1e-4, .max = 1.0});
  stage.Option("mark-sigma-m", &options.mark_sigma_m, "of the platform on a point, 1 sigma per axis (m)",
               {.min = 1e-4, .max = 1.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    PlannedNetwork network = SolvedNetwork(files);
    if (!keep_points) network.existing.clear();
    std::vector<int> taken;
    for (const ExistingPoint& point : network.existing) taken.push_back(point.pose);
    const auto plan =
        survey::PlanControl(network.block.graph, static_cast<int>(network.block.num_submaps), taken, options);
    if (!plan)
      throw formats::DataError((files.track.empty() ? files.floor_plan : files.track).string() +
                               ": too short to plan control, or its parts do not hang together");
    const formats::PlanReport report = ReportOf(*plan, network);
    formats::WritePlan(files.output, report, run.Provenance());
    if (!files.picture.empty()) formats::WritePlanPicture(files.picture, report);
    run.Message(Summary(report));
  });
}
