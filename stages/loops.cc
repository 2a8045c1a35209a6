// SPDX-License-Identifier: Apache-2.0
//
// plumbline-loops: constraints between submaps and scans that are not neighbours in time.
#include <algorithm>

#include "formats/artefacts.h"
#include "pipeline/stage.h"
#include "survey/graph/loop_search.h"

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "loops", "Find where a block comes back to places it has seen (loop closures).",
      "plumbline loops --session work/B1/session.sqlite --track work/B1/track.sqlite --output work/B1/loops.sqlite");
  std::filesystem::path session_file;
  std::filesystem::path track_file;
  std::filesystem::path output;
  survey::LoopOptions options;
  stage.Input("session", &session_file, "session of the block");
  stage.Input("track", &track_file, "its track");
  stage.Output("output", &output, "loops.sqlite to write");
  stage.Option("search-cell-size-m", &options.place.search_cell_size_m, "cell of branch and bound (m)",
               {.min = 0.02, .max = 1.0});
  stage.Option("max-range-m", &options.max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  stage.Option("node-spacing-m", &options.node_spacing_m, "one scan per this much path is searched (m)", {.min = 0.05});
  stage.Option("min-detour-m", &options.min_detour_m, "scans closer along the track are no loops (m)", {.min = 0.0});
  stage.Option("reach-m", &options.reach_m, "search submaps that come this close (m)", {.min = 0.0});
  stage.Option("drift-m-per-m", &options.drift_m_per_m, "sigma of the track's drift along the way", {.min = 0.0});
  stage.Option("drift-rad-per-sqrt-m", &options.drift_rad_per_sqrt_m, "sigma of the heading's drift along the way",
               {.min = 0.0});
  stage.Option("max-window-m", &options.max_window_m, "largest search window (m)", {.min = 0.0});
  stage.Option("min-score-ratio", &options.min_score_ratio, "worst match, relative to the submap's own scans",
               {.min = 0.0, .max = 1.0});
  stage.Option("min-overlap", &options.min_overlap, "least share of a scan on cells that the submap has seen",
               {.min = 0.0, .max = 1.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const survey::Session session = formats::ReadSession(session_file);
    const survey::Track track = formats::ReadTrack(track_file);
    if (track.scans.size() != session.scans.size()) {
      throw formats::DataError(track_file.string() + ": has " + std::to_string(track.scans.size()) + " scans, " +
                               session_file.string() + " has " + std::to_string(session.scans.size()) +
                               ": they do not belong together");
    }
    pipeline::Progress progress = run.Track("submaps", static_cast<std::int64_t>(track.submaps.size()));
    const survey::Loops loops = survey::FindLoops(session, track, options, [&](std::size_t done, std::size_t) {
      progress.Advance(static_cast<std::int64_t>(done));
    });
    formats::WriteLoops(output, loops, run.Provenance());
    const auto accepted =
        std::count_if(loops.loops.begin(), loops.loops.end(), [](const survey::Loop& loop) { return loop.accepted; });
    run.Message(std::to_string(accepted) + " loops accepted, " +
                std::to_string(static_cast<long>(loops.loops.size()) - accepted) + " rejected, " +
                std::to_string(loops.candidates_searched) + " places searched");
  });
}
