// SPDX-License-Identifier: Apache-2.0
//
// plumbline-join: the joint adjustment of a site. Every block's observations, the control network once for all of them,
// and matches between blocks that have seen the same place. Nothing depends on it: without it each block stands on its
// own control.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "formats/artefacts.h"
#include "formats/digest.h"
#include "formats/joint_file.h"
#include "pipeline/stage.h"
#include "survey/graph/block_matches.h"
#include "survey/graph/site_adjustment.h"

namespace {

namespace fs = std::filesystem;
using pipeline::NamedFile;

struct JoinFiles {
  fs::path control;
  std::vector<NamedFile> sessions, tracks, solutions, graphs;
  fs::path output;
  fs::path report;
};

// A block with what the joint adjustment needs of it but its session, which is large.
struct Block {
  fs::path session;
  survey::Solution solution;
  survey::Track track;  // in the site frame
  std::vector<survey::ScanStamp> stamps;
};

fs::path FileOf(const std::string& block, const std::vector<NamedFile>& files, const std::string& option) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const NamedFile& file) { return file.name == block; });
  if (found == files.end()) throw formats::UsageError("--" + option + " " + block + "=FILE is missing");
  return found->file;
}

void RequireSameRun(const fs::path& graph, const fs::path& solution) {
  if (formats::ReadProvenance(graph).Own().Id() == formats::ReadProvenance(solution).Own().Id()) return;
  throw formats::DataError(graph.string() + ": was not written by the run of adjust that wrote " + solution.string());
}

std::vector<survey::SiteBlock> ReadGraphs(const JoinFiles& files) {
  std::vector<survey::SiteBlock> blocks;
  for (const NamedFile& solution : files.solutions) {
    for (const survey::SiteBlock& other : blocks) {
      if (other.name == solution.name) throw formats::UsageError("--solution " + solution.name + " is given twice");
    }
    const fs::path graph = FileOf(solution.name, files.graphs, "graph");
    RequireSameRun(graph, solution.file);
    blocks.push_back({.name = solution.name, .graph = formats::ReadGraph(graph), .covariances = {}});
  }
  return blocks;
}

Block ReadBlock(const NamedFile& solution, const JoinFiles& files) {
  const fs::path track = FileOf(solution.name, files.tracks, "track");
  Block block{.session = FileOf(solution.name, files.sessions, "session"),
              .solution = formats::ReadSolution(solution.file),
              .track = formats::ReadTrack(track),
              .stamps = formats::ReadScanStamps(solution.file)};
  if (block.track.scans.size() != block.solution.scans.size() ||
      block.track.submaps.size() != block.solution.submaps.size())
    throw formats::DataError(track.string() + ": does not belong to " + solution.file.string());
  block.track = survey::TrackInSite(block.track, block.solution);
  return block;
}

// Whether some scans of two blocks may be near enough to be matched.
bool Near(const survey::Track& a, const survey::Track& b, double reach_m) {
  const auto box = [](const survey::Track& track) {
    Eigen::AlignedBox2d box;
    for (const survey::TrackedScan& scan : track.scans) box.extend(scan.local_from_scan.Translation());
    return box;
  };
  return box(a).exteriorDistance(box(b)) < reach_m;
}

// Two sessions are in memory at a time.
std::vector<survey::MatchedPair> MatchAll(const std::vector<Block>& blocks, const survey::BlockMatchOptions& options,
                                          pipeline::StageRun& run) {
  std::vector<survey::MatchedPair> pairs;
  pipeline::Progress progress = run.Track("blocks", static_cast<std::int64_t>(blocks.size()));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    std::optional<survey::Session> first;
    for (std::size_t j = i + 1; j < blocks.size(); ++j) {
      if (!Near(blocks[i].track, blocks[j].track, options.reach_m)) continue;
      if (!first) first = formats::ReadSession(blocks[i].session);
      const survey::Session second = formats::ReadSession(blocks[j].session);
      std::vector<survey::Loop> matches =
          survey::MatchBlocks({&*first, &blocks[i].track}, {&second, &blocks[j].track}, options);
      if (!matches.empty()) pairs.push_back({i, j, std::move(matches)});
    }
    progress.Advance(static_cast<std::int64_t>(i + 1));
  }
  return pairs;
}

void Summarize(const survey::JointSummary& summary, pipeline::StageRun& run) {
  char text[200];
  for (const survey::JointPair& pair : summary.pairs) {
    std::snprintf(text, sizeof text, ": %d of %d matches used, rms %.1f mm before (expected %.1f mm), %.1f mm after",
                  pair.num_used, pair.num_matches, 1000.0 * pair.rms_before, 1000.0 * pair.sigma,
                  1000.0 * pair.rms_after);
    run.Message(pair.block_a + " - " + pair.block_b + text);
    if (pair.contradicts)
      run.Warn("blocks " + pair.block_a + " and " + pair.block_b +
               " contradict each other beyond their covariance: their matches are not used");
  }
  for (const survey::JointBlock& block : summary.blocks) {
    std::snprintf(text, sizeof text, ": moved by %.1f mm rms, %.1f mm at most; sigma %.1f mm, before %.1f mm",
                  1000.0 * block.rms_shift, 1000.0 * block.max_shift, 1000.0 * block.sigma_after,
                  1000.0 * block.sigma_before);
    run.Message(block.name + text);
  }
}

// A solution names its own block's inputs, and joint.json for all others: with the records of all blocks in each file a
// site's files would grow with the square of their number.
formats::Provenance ProvenanceOfBlock(const std::string& block, const fs::path& report, pipeline::StageRun& run) {
  std::vector<formats::ProvenanceInput> inputs = {
      {.role = "joint adjustment", .sha256 = formats::Sha256OfFile(report)}};
  for (const formats::ProvenanceInput& input : run.Provenance().Own().inputs) {
    if (input.role == "control" || input.role.ends_with(" " + block)) inputs.push_back(input);
  }
  std::stable_sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) { return a.role < b.role; });
  return formats::WithInputs(run.Provenance(), std::move(inputs));
}

// Blocks keep their order; those that take no part keep their solutions.
void Run(const JoinFiles& files, bool joint, double robust_scale, const survey::BlockMatchOptions& options,
         pipeline::StageRun& run) {
  std::vector<survey::SiteBlock> graphs = ReadGraphs(files);
  std::vector<Block> blocks;
  for (const NamedFile& solution : files.solutions) blocks.push_back(ReadBlock(solution, files));
  survey::SiteAdjustment adjustment{.usable = true, .message = "", .summary = {}};
  if (joint) {
    adjustment =
        survey::AdjustSite(formats::ReadControl(files.control), robust_scale, &graphs, MatchAll(blocks, options, run));
    if (!adjustment.usable) throw formats::DataError(files.control.string() + ": " + adjustment.message);
  }
  survey::JointSummary& summary = adjustment.summary;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (graphs[b].covariances.empty()) continue;
    summary.blocks.push_back(
        survey::MoveSolution(graphs[b], blocks[b].track, survey::ClockStamps(blocks[b].stamps), &blocks[b].solution));
  }
  formats::WriteJoint(files.report, summary, run.Provenance());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    formats::WriteSolution(files.output / graphs[b].name / "solution.sqlite", blocks[b].solution, blocks[b].stamps,
                           ProvenanceOfBlock(graphs[b].name, files.report, run));
  }
  Summarize(summary, run);
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "join", "Adjust all blocks of a site together, with matches between those that have seen the same place.",
      "plumbline join --joint true --control work/joint-control.sqlite --session B1=work/B1/session.sqlite --track "
      "B1=work/B1/track.sqlite --graph B1=work/B1/graph.sqlite --solution B1=work/B1/adjusted.sqlite --output work "
      "--report work/joint.json");
  JoinFiles files;
  bool joint = false;
  double robust_scale = 2.0;
  survey::BlockMatchOptions options;
  stage.Input("control", &files.control, "joint extract of the control points, without checks");
  stage.NamedInputs("session", &files.sessions, "session of each block", true);
  stage.NamedInputs("track", &files.tracks, "track of each block", true);
  stage.NamedInputs("graph", &files.graphs, "graph.sqlite that adjust wrote for each block", true);
  stage.NamedInputs("solution", &files.solutions, "solution that adjust wrote for each block", true);
  stage.Output("output", &files.output, "folder for BLOCK/solution.sqlite");
  stage.Output("report", &files.report, "joint.json to write: what changed");
  stage.Option("joint", &joint, "adjust all blocks together; without, each keeps the solution by its own control");
  stage.Option("match-robust-sigmas", &robust_scale, "beyond this a match between blocks loses weight", {.min = 0.1});
  stage.Option("max-range-m", &options.max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  stage.Option("node-spacing-m", &options.node_spacing_m, "one scan per this much path is matched (m)", {.min = 0.05});
  stage.Option("reach-m", &options.reach_m, "match in submaps of other blocks that come this close (m)", {.min = 0.0});
  stage.Option("min-score-ratio", &options.min_score_ratio, "worst match, relative to the submap's own scans",
               {.min = 0.0, .max = 1.0});
  stage.Option("min-overlap", &options.min_overlap, "least share of a scan on cells that the submap has seen",
               {.min = 0.0, .max = 1.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) { Run(files, joint, robust_scale, options, run); });
}
