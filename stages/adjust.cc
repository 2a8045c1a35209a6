// SPDX-License-Identifier: Apache-2.0
//
// plumbline-adjust: the back end. Ties a block to its control points; without control it stays in its local frame.
#include <cmath>
#include <cstdio>

#include "formats/answers_file.h"
#include "formats/artefacts.h"
#include "formats/digest.h"
#include "formats/feedback_files.h"
#include "pipeline/stage.h"
#include "survey/edits/map_arrow.h"
#include "survey/graph/block_adjustment.h"

namespace {

std::string Summary(const survey::Solution& solution) {
  const survey::AdjustmentStatistics& statistics = solution.statistics;
  std::string text =
      std::to_string(statistics.num_nodes) + " nodes, " + std::to_string(statistics.num_loops) + " loops, ";
  if (!solution.tied) return text + "not tied to control: local frame";
  double squares = 0.0;
  for (const survey::SolvedMark& mark : solution.marks) {
    if (mark.used) squares += mark.residual.squaredNorm();
  }
  char residuals[160];
  std::snprintf(
      residuals, sizeof residuals,
      "%d control marks, rms of their residuals %.1f mm (a fit, not an accuracy), scale %+.0f ppm, sigma zero %.2f",
      statistics.num_control_marks, 1000.0 * std::sqrt(squares / std::max(1, statistics.num_control_marks)),
      1e6 * (solution.rigid_scale - 1.0), statistics.sigma_zero);
  return text + residuals;
}

std::string Described(const survey::SolvedMark& arrow) {
  char text[80];
  std::snprintf(text, sizeof text, ": the map lies %.3f m from its head", arrow.residual.norm());
  return arrow.point + text;
}

// People's arrows as observations beside control, where control fixes the block.
std::vector<survey::MapArrow> AddArrows(const std::filesystem::path& file, const std::vector<survey::StampNs>& stamps,
                                        survey::Track* track, survey::ControlNetwork* control,
                                        pipeline::StageRun& run) {
  const std::vector<survey::MapArrow> arrows = formats::ReadArrows(file);
  if (arrows.empty()) return {};
  if (!survey::IsTiedByControl(*track, *control)) {
    run.Warn("arrows that people drew are not used: the block is not tied to two control points");
    return {};
  }
  for (const std::string& name : survey::AddArrows(arrows, stamps, track, control))
    run.Warn("arrow " + name + ": its scan is gone");
  run.AddInput({"arrows", formats::Sha256(formats::CanonicalText(arrows))});
  return arrows;
}

std::string Factors(const survey::NetworkFactors& factors) {
  char text[160];
  std::snprintf(text, sizeof text, "; sigmas of the track x %.2f, of the loops x %.2f%s", std::sqrt(factors.track),
                std::sqrt(factors.loops), factors.told ? "" : " (few loops: by what is usual, and by control)");
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("adjust", "Adjust a block with its loops and control points.",
                        "plumbline adjust --track work/B1/track.sqlite --loops work/B1/loops.sqlite --control "
                        "work/B1/control.sqlite --output "
                        "work/B1/solution.sqlite");
  std::filesystem::path track_file;
  std::filesystem::path loops_file;
  std::filesystem::path control_file;
  std::filesystem::path output;
  std::filesystem::path graph;
  survey::BlockAdjustmentOptions options;
  stage.Input("track", &track_file, "track of the block");
  stage.Input("loops", &loops_file, "its loops");
  stage.OptionalInput("control", &control_file, "its extract of the control points; without: local frame");
  std::vector<std::filesystem::path> answer_files;
  stage.Inputs("answers", &answer_files, "a person's answers about the block's scans, JSON", false,
               pipeline::Content::kParsed);
  std::filesystem::path arrows_file;
  stage.OptionalInput("arrows", &arrows_file, "arrows.json: what people say lies elsewhere",
                      pipeline::Content::kParsed);
  stage.Output("output", &output, "solution.sqlite to write");
  stage.OptionalOutput("graph", &graph, "graph.sqlite to write: the observations, for `plumbline join`");
  stage.Option("loop-robust-sigmas", &options.tie.solver.robust_scale, "beyond this a loop loses weight", {.min = 0.1});
  stage.Option("allow-single-point", &options.allow_single_point,
               "accept a block with one control point (no direction)");
  stage.Option("covariance-spacing-m", &options.covariance_spacing_m,
               "path between poses whose covariance is written (m)", {.min = 0.1});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    std::vector<survey::ScanStamp> stamps;
    survey::Track track = formats::ReadTrack(track_file, &stamps);
    const survey::Loops loops = formats::ReadLoops(loops_file);
    survey::ControlNetwork control =
        control_file.empty() ? survey::ControlNetwork{} : formats::ReadControl(control_file);
    const survey::Answers answers = formats::ReadAnswers(answer_files, survey::ClockStamps(stamps));
    if (!answers.empty()) run.AddInput({"answers", formats::Sha256(formats::CanonicalText(answers))});
    std::vector<survey::MapArrow> arrows;
    if (!arrows_file.empty()) arrows = AddArrows(arrows_file, survey::ClockStamps(stamps), &track, &control, run);
    survey::BlockAdjustment adjustment =
        survey::AdjustBlock(track, loops, control, survey::ClockStamps(stamps), options, answers);
    if (!adjustment.usable) throw formats::DataError(track_file.string() + ": " + adjustment.message);
    survey::KeepArrows(arrows, adjustment.solution, &adjustment.graph);
    for (const survey::SolvedMark& arrow : survey::TakeArrows(arrows, &adjustment.solution)) {
      if (arrow.used) run.Message(Described(arrow));  // findings tell of the others
    }
    formats::WriteSolution(output, adjustment.solution, stamps, run.Provenance());
    if (!graph.empty()) formats::WriteGraph(graph, adjustment.graph, run.Provenance());
    for (const std::string& finding : adjustment.solution.findings) run.Warn(finding);
    run.Message(Summary(adjustment.solution) + Factors(adjustment.factors));
  });
}
