// SPDX-License-Identifier: Apache-2.0
//
// plumbline-track: the front end. Reads the session of a block, writes the pose of every scan in the block's local
// frame.
#include "formats/artefacts.h"
#include "pipeline/stage.h"
#include "survey/submaps/tracker.h"

namespace {

void DeclareOptions(pipeline::Stage* stage, survey::TrackOptions* options) {
  stage->Option("surface-cell-size-m", &options->map.surface_cell_size_m, "cell of the surfaces (m), surface matcher",
                {.min = 0.02, .max = 1.0});
  stage->Option("submap-cell-size-m", &options->map.grid.cell_size_m, "cell of the submaps (m), occupancy matcher",
                {.min = 0.005, .max = 1.0});
  stage->Option("max-range-m", &options->max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  stage->Option("max-points", &options->map.max_points, "end points used to match a scan", {.min = 20, .max = 100000});
  stage->Option("point-spacing-m", &options->map.point_spacing_m, "end points closer along the scan are thinned (m)",
                {.min = 0.0});
  stage->Option("insert-distance-m", &options->insert_distance_m, "a scan is drawn after this motion (m) ...",
                {.min = 0.0});
  stage->Option("insert-angle-rad", &options->insert_angle_rad, "... or this turn (rad)", {.min = 0.0});
  stage->Option("submap-nodes", &options->submap_nodes, "scans drawn into one submap", {.min = 2});
  stage->Option("search-half-width-m", &options->search_half_width_m, "search window when a match is poor (m)",
                {.min = 0.0});
  stage->Option("search-half-angle-rad", &options->search_half_angle_rad, "search window when a match is poor (rad)",
                {.min = 0.0});
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("track",
                        "Estimate the pose of every scan of a block in its local frame (LiDAR SLAM, without control).",
                        "plumbline track --session work/B1/session.sqlite --output work/B1/track.sqlite");
  std::filesystem::path session_file;
  std::filesystem::path output;
  survey::TrackOptions options;
  std::string matcher = "surfaces";
  stage.Input("session", &session_file, "session of the block");
  stage.Output("output", &output, "track.sqlite to write");
  stage.Option("matcher", &matcher, "surfaces, or occupancy: [CN] eq. (6)-(7) as written", {"surfaces", "occupancy"});
  bool use_odometry = true;
  stage.Option("use-odometry", &use_odometry, "false: as if the wheels had not been recorded");
  DeclareOptions(&stage, &options);
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    if (matcher == "occupancy") options.map.matcher = survey::Matcher::kOccupancy;
    survey::Session session = formats::ReadSession(session_file);
    if (!use_odometry) session.odometry.clear();
    pipeline::Progress progress = run.Track("scans", static_cast<std::int64_t>(session.scans.size()));
    const survey::Track track = survey::TrackBlock(
        session, options, [&](std::size_t done) { progress.Advance(static_cast<std::int64_t>(done)); });
    formats::WriteTrack(output, track, survey::StampsOfScans(session), run.Provenance());
    run.Message(std::to_string(track.scans.size()) + " scans, " + std::to_string(track.submaps.size()) + " submaps, " +
                std::to_string(track.constraints.size()) + " constraints, " + std::to_string(track.requests.size()) +
                " review requests");
  });
}
