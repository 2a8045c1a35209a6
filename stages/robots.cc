// SPDX-License-Identifier: Apache-2.0
//
// plumbline-robots: what people forbade to robots, as a keep-out mask and as shapes beside the map for ROS.
#include "formats/raster_file.h"
#include "formats/vector_objects.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/edits/keepout.h"
#include "survey/edits/site_edits.h"

int main(int argc, char** argv) {
  pipeline::Stage stage("robots", "Write the forbidden areas of a site for robots, beside its ROS map.",
                        "plumbline robots --site-map out/site.tif --edits B1=work/B1/edits.json --output out/ros");
  std::filesystem::path site_map, output;
  std::vector<pipeline::NamedFile> edits;
  stage.Input("site-map", &site_map, "site.tif, whose cells the mask has");
  stage.NamedInputs("edits", &edits, "edits.json of each block on the map", true);
  stage.Output("output", &output, "folder for keepout.pgm, keepout.yaml, keepout_local.yaml and vector_objects.yaml");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::RasterLabel label;
    const survey::SiteRaster frame = formats::ReadRasterFrame(site_map, &label);
    const std::vector<survey::MapEdit> areas = survey::ForbiddenAreas(pipeline::ReadBlockEdits(edits));
    formats::WriteKeepoutMask(output, survey::KeepoutStrips(frame, areas), label);
    formats::WriteVectorObjects(output / "vector_objects.yaml", areas, frame);
    run.Message(std::to_string(areas.size()) + (areas.size() == 1 ? " forbidden area" : " forbidden areas"));
  });
}
