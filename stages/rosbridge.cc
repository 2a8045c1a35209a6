// SPDX-License-Identifier: Apache-2.0
//
// plumbline-rosbridge: the site's map as messages for AR clients that speak rosbridge; `plumbline edits add` takes back
// what a person made of it.
#include "formats/rosbridge.h"

#include "formats/raster_file.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/edits/keepout.h"
#include "survey/edits/site_edits.h"
#include "survey/grid/mosaic.h"

int main(int argc, char** argv) {
  pipeline::Stage stage("rosbridge", "Write the map of a site as JSON lines of the rosbridge protocol.",
                        "plumbline rosbridge --map B1=work/B1/map.tif --edits B1=work/B1/edits.json --output "
                        "map.rosbridge.jsonl");
  std::vector<pipeline::NamedFile> maps, edits;
  std::filesystem::path output;
  std::string version = "ros2";
  stage.NamedInputs("map", &maps, "map.tif of each block on the site's map", true);
  stage.NamedInputs("edits", &edits, "edits.json of each block: the topic /keepout_filter_mask too", false);
  stage.Output("output", &output, "file to write");
  stage.Option("message-types", &version, "names of types and stamps", {"ros1", "ros2"});
  return stage.Run(argc, argv, [&](pipeline::StageRun&) {
    std::vector<survey::RasterStrips> blocks;
    for (const pipeline::NamedFile& map : maps) {
      formats::RasterLabel label;
      blocks.push_back(formats::OpenRaster(map.file, &label));
    }
    std::vector<formats::RosTopic> topics = {{"/map", survey::MosaicOf(std::move(blocks), {})}};
    if (!edits.empty()) {
      topics.push_back(
          {"/keepout_filter_mask",
           survey::KeepoutStrips(topics.front().grid.frame, survey::ForbiddenAreas(pipeline::ReadBlockEdits(edits)))});
    }
    formats::WriteRosbridge(output, topics,
                            version == "ros1" ? formats::RosVersion::kRos1 : formats::RosVersion::kRos2);
  });
}
