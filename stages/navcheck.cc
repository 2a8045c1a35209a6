// SPDX-License-Identifier: Apache-2.0
//
// plumbline-navcheck: goals of a robot on the maps as scanned and as edited ([AS] figure 12).
#include <cstdio>

#include "formats/nav_check_file.h"
#include "formats/raster_file.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/edits/site_edits.h"
#include "survey/grid/mosaic.h"
#include "survey/planning/robot_path.h"

namespace {

using formats::NavCheck;
using formats::NavGoal;
using formats::NavResult;
using pipeline::NamedFile;

survey::SiteRaster ReadSite(const std::vector<NamedFile>& files, formats::RasterLabel* label) {
  std::vector<survey::SiteRaster> blocks;
  for (const NamedFile& file : files) blocks.push_back(formats::ReadRaster(file.file, label));
  std::vector<const survey::SiteRaster*> pointers;
  for (const survey::SiteRaster& block : blocks) {
    if (block.cell_size_m != blocks.front().cell_size_m)
      throw formats::DataError(files.front().file.string() + ": the blocks have different cells");
    pointers.push_back(&block);
  }
  return survey::Mosaic(pointers, {});
}

// As a wall.
void Forbid(const std::vector<NamedFile>& files, survey::SiteRaster* map) {
  for (const survey::MapEdit& area : survey::ForbiddenAreas(pipeline::ReadBlockEdits(files)))
    survey::ForEachCell(area, *map, [&](int column, int row) { map->At(column, row) = survey::kEditedLogOdds; });
}

NavResult Check(const survey::RobotSpace& space, const NavGoal& start, const NavGoal& goal) {
  return {space.ClearanceAt(goal.place), space.Path(start.place, goal.place)};
}

std::string Described(const NavResult& result) {
  if (result.path.empty()) return "not reachable";
  char text[64];
  std::snprintf(text, sizeof text, "%.1f m", survey::LengthOf(result.path));
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("navcheck",
                        "Tell which goals a robot reaches on the maps as scanned and as people edited them.",
                        "plumbline navcheck --grid B1=work/B1/grid.tif --map B1=work/B1/map.tif --edits "
                        "B1=work/B1/edits.json --goals goals.csv --output nav_check.json --layer nav_check.geojson");
  std::vector<NamedFile> grids, maps, edits;
  std::filesystem::path goals_file, output, layer;
  survey::RobotOptions options;
  stage.NamedInputs("grid", &grids, "grid.tif of each block: before", true);
  stage.NamedInputs("map", &maps, "map.tif of each block: after", true);
  stage.NamedInputs("edits", &edits, "edits.json of each block, for the forbidden areas", false);
  stage.Input("goals", &goals_file, "CSV name,easting,northing; the first row is where the robot starts",
              pipeline::Content::kTextWithoutComments);
  stage.Output("output", &output, "nav_check.json to write");
  stage.OptionalOutput("layer", &layer, "GeoJSON to write: the ways as lines");
  stage.Option("robot-radius-m", &options.radius_m, "the robot keeps this from what it must not touch (m)",
               {.min = 0.0, .max = 10.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const std::vector<NavGoal> goals = formats::ReadNavGoals(goals_file);
    formats::RasterLabel label;
    const survey::RobotSpace before(ReadSite(grids, &label), options);
    survey::SiteRaster edited = ReadSite(maps, &label);
    Forbid(edits, &edited);
    const survey::RobotSpace after(edited, options);
    std::vector<NavCheck> checks;
    for (std::size_t i = 1; i < goals.size(); ++i) {
      checks.push_back({goals[i], Check(before, goals[0], goals[i]), Check(after, goals[0], goals[i])});
      run.Message(goals[i].name + ": " + Described(checks.back().before) + " before, " +
                  Described(checks.back().after) + " after the edits");
    }
    formats::WriteNavChecks(output, goals[0], checks, run.Provenance());
    if (!layer.empty()) formats::WriteNavLayer(layer, checks, label.frame.crs);
  });
}
