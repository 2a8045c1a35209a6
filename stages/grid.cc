// SPDX-License-Identifier: Apache-2.0
//
// plumbline-grid: the map of a block, rendered from all scans at their final poses on the site's cells.
#include "formats/posed_session.h"
#include "formats/raster_file.h"
#include "pipeline/stage.h"
#include "survey/graph/map_uncertainty.h"
#include "survey/submaps/block_raster.h"

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "grid", "Render the occupancy grid of a block from all its scans.",
      "plumbline grid --session work/B1/session.sqlite --solution work/B1/solution.sqlite --output work/B1/grid.tif");
  std::filesystem::path session_file;
  std::filesystem::path solution_file;
  std::filesystem::path output;
  survey::RenderOptions options;
  stage.Input("session", &session_file, "session of the block");
  stage.Input("solution", &solution_file, "its solution");
  stage.Output("output", &output, "grid.tif to write");
  stage.Option("cell-size-m", &options.grid.cell_size_m, "cell of the map (m)", {.min = 0.005, .max = 10.0});
  stage.Option("max-range-m", &options.max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  stage.Option("free-range-m", &options.free_range_m,
               "beams without return clear the map up to here (m); 0: they tell nothing", {.min = 0.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const formats::PosedSession block = formats::ReadPosedSession(session_file, solution_file);
    const std::vector<survey::Pose2>& poses = block.site_from_scan;
    pipeline::Progress progress = run.Track("scans", static_cast<std::int64_t>(poses.size()));
    const survey::RasterStrips drawn = survey::RenderBlock(
        block.session, poses, options, [&](std::size_t done) { progress.Advance(static_cast<std::int64_t>(done)); });
    const survey::SiteRaster& frame = drawn.frame;
    if (frame.width == 0)
      throw formats::DataError(session_file.string() + ": no scan has a range within " +
                               std::to_string(options.max_range_m) + " m: the map is empty");
    formats::WriteRaster(output, survey::WithSigmas(drawn, block.solution),
                         {.frame = block.solution.frame, .tied = block.solution.tied}, run.Provenance());
    run.Message(std::to_string(frame.width) + " x " + std::to_string(frame.height) + " cells of " +
                std::to_string(frame.cell_size_m) + " m");
  });
}
