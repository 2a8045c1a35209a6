// SPDX-License-Identifier: Apache-2.0
//
// plumbline-plan: predicts a block's accuracy against number and place of its control points from a first walk, before
// anything is surveyed, and says where the next points serve best.
#include <cstdio>

#include "formats/artefacts.h"
#include "formats/plan_file.h"
#include "pipeline/stage.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/variance_components.h"
#include "survey/planning/control_plan.h"

namespace {

struct PlanFiles {
  std::filesystem::path track;
  std::filesystem::path loops;
  std::filesystem::path solution;
  std::filesystem::path output;
  std::filesystem::path picture;
};

// The names of the block's control points that are there already, by the pose that saw each first.
std::vector<std::pair<int, std::string>> ExistingPoints(const survey::Solution& solution,
                                                        const survey::BlockGraph& block) {
  std::vector<std::pair<int, std::string>> existing;
  for (const survey::SolvedMark& mark : solution.marks) {
    const bool known =
        std::any_of(existing.begin(), existing.end(), [&](const auto& point) { return point.second == mark.point; });
    if (mark.used && !known) existing.emplace_back(block.PoseOf(mark.scan), mark.point);
  }
  return existing;
}

formats::PlanReport ReportOf(const survey::ControlPlan& plan, const survey::BlockGraph& block,
                             const survey::Solution& solution,
                             const std::vector<std::pair<int, std::string>>& existing) {
  formats::PlanReport report{.tied = solution.tied, .crs = solution.frame.crs};
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    const survey::PlanStep& step = plan.steps[i];
    const bool old = i < existing.size();
    report.points.push_back({old ? existing[i].second : "new " + std::to_string(i + 1 - existing.size()), old,
                             solution.site_from_local * step.place, step.rms, step.max});
  }
  for (std::size_t i = 0; i < plan.path.size(); ++i) {
    const survey::Pose2& pose = block.graph.poses[static_cast<std::size_t>(plan.path[i])];
    report.path.push_back({solution.site_from_local * pose.Translation(), plan.sigma_of_path[i]});
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
                        "plumbline plan --track work/B1/track.sqlite --loops work/B1/loops.sqlite --solution "
                        "work/B1/solution.sqlite --output plan.json --picture plan.svg");
  PlanFiles files;
  survey::ControlPlanOptions options;
  stage.Input("track", &files.track, "track of a first walk through the block");
  stage.Input("loops", &files.loops, "its loops");
  stage.OptionalInput("solution", &files.solution, "its solution: site coordinates, and its control points come first");
  stage.Output("output", &files.output, "plan.json to write");
  stage.OptionalOutput("picture", &files.picture, "SVG to write: curve and map");
  stage.Option("max-points", &options.max_points, "control points in all", {.min = 2, .max = 100});
  stage.Option("candidate-spacing-m", &options.candidate_spacing_m, "path between places where a point could be (m)",
               {.min = 0.5, .max = 100.0});
  stage.Option("control-sigma-m", &options.control_sigma_m, "of a control point, 1 sigma per axis (m)",
               {.min = 1e-4, .max = 1.0});
  stage.Option("mark-sigma-m", &options.mark_sigma_m, "of the platform on a point, 1 sigma per axis (m)",
               {.min = 1e-4, .max = 1.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const survey::Track track = formats::ReadTrack(files.track);
    survey::BlockGraph block = survey::MakeBlockGraph(track, formats::ReadLoops(files.loops));
    const survey::Solution solution =
        files.solution.empty() ? survey::Solution{} : formats::ReadSolution(files.solution);
    if (!files.solution.empty() && solution.scans.size() != track.scans.size())
      throw formats::DataError(files.solution.string() + ": does not belong to " + files.track.string());
    const survey::PoseGraphSummary summary = survey::SolveFree({}, &block.graph).summary;
    if (!summary.usable) throw formats::DataError(files.track.string() + ": " + summary.message);
    survey::FreezeRobustWeights(&block.graph);
    const std::vector<std::pair<int, std::string>> existing = ExistingPoints(solution, block);
    std::vector<int> taken;
    for (const auto& [pose, name] : existing) taken.push_back(pose);
    const auto plan = survey::PlanControl(block.graph, static_cast<int>(block.num_submaps), taken, options);
    if (!plan)
      throw formats::DataError(files.track.string() + ": too short to plan control, or its parts do not hang together");
    const formats::PlanReport report = ReportOf(*plan, block, solution, existing);
    formats::WritePlan(files.output, report, run.Provenance());
    if (!files.picture.empty()) formats::WritePlanPicture(files.picture, report);
    run.Message(Summary(report));
  });
}
