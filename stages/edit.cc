// SPDX-License-Identifier: Apache-2.0
//
// plumbline-edit: a block's map out of its grid and the map edits that people drew.
#include <algorithm>

#include "formats/edits_file.h"
#include "formats/raster_file.h"
#include "pipeline/descent.h"
#include "pipeline/stage.h"
#include "survey/edits/map_edit.h"

namespace {

namespace fs = std::filesystem;

// An edit this far from a map was drawn in other coordinates.
constexpr double kTooFar_m = 10000.0;

void Apply(const fs::path& file, std::size_t number, const survey::MapEdit& edit, survey::SiteRaster* raster,
           pipeline::StageRun& run) {
  const std::string what = file.string() + ": feature " + std::to_string(number);
  const double distance_m = survey::DistanceToRaster(edit, *raster);
  if (distance_m > kTooFar_m)
    throw formats::DataError(what + ": lies " + std::to_string(static_cast<std::int64_t>(distance_m / 1000)) +
                             " km outside the map; edits must be in site coordinates (easting, northing)");
  const std::int64_t changed = survey::ApplyEdit(edit, raster);
  run.Message(what + " (" + std::string(Name(edit.state)) + "): " + std::to_string(changed) + " cells" +
              (distance_m > 0 ? ", outside this block's map" : ""));
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("edit", "Apply people's map edits to the grid of a block.",
                        "plumbline edit --grid work/B1/grid.tif --solution work/B1/solution.sqlite "
                        "--edits edits/cars.geojson --output work/B1/map.tif");
  fs::path grid_file;
  fs::path solution_file;
  std::vector<fs::path> edit_files;
  fs::path output;
  stage.Input("grid", &grid_file, "grid of the block");
  stage.Input("solution", &solution_file, "the solution that the grid was made from");
  stage.Inputs("edits", &edit_files, "GeoJSON files with edits; applied in order of their names", false);
  stage.Output("output", &output, "map.tif to write");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::RasterLabel label;
    survey::SiteRaster raster = formats::ReadRaster(grid_file, &label);
    pipeline::RequireDescent(grid_file, solution_file);
    std::sort(edit_files.begin(), edit_files.end(),
              [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
    if (!edit_files.empty() && !label.tied)
      run.Warn("the block is not tied to control: the edits are taken in its local frame");
    for (const fs::path& file : edit_files) {
      std::size_t number = 0;
      for (const survey::MapEdit& edit : formats::ReadEdits(file, label.frame.crs)) {
        Apply(file, ++number, edit, &raster, run);
      }
    }
    formats::WriteRaster(output, raster, label, run.Provenance());
    if (edit_files.empty()) run.Message("no edits: the map is the grid");
  });
}
