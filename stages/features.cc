// SPDX-License-Identifier: Apache-2.0
//
// plumbline-features: where a map shows the corners and pillars of the surveyor's list.
#include <algorithm>

#include "formats/artefacts.h"
#include "formats/features_csv.h"
#include "formats/posed_session.h"
#include "formats/raster_file.h"
#include "pipeline/stage.h"
#include "survey/features/locate.h"
#include "survey/graph/place_uncertainty.h"
#include "survey/submaps/block_raster.h"
#include "survey/submaps/drawn_hits.h"

namespace {

constexpr double kSamePlace_m = 0.03;

survey::HitCells HitsNear(const std::vector<survey::NamedFeature>& wanted, const survey::SiteRaster& map,
                          const formats::PosedSession& block, double radius_m, double max_range_m) {
  std::vector<Eigen::Vector2d> places;
  for (const survey::NamedFeature& one : wanted) places.push_back(one.position_in_site);
  return survey::DrawnHits(block.session, block.site_from_scan, max_range_m, map, places, radius_m);
}

// The covariance of the place from that of its reading.
void AddPoses(const survey::Solution& solution, survey::MapFeature* feature) {
  if (!feature->found) return;
  const auto of_poses = survey::PlaceCovariance(feature->position_in_site, solution);
  feature->covariance = feature->reading + of_poses.value_or(Eigen::Matrix2d::Zero());
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("features", "Find the surveyed corners and pillars in the map of a block.",
                        "plumbline features --map work/B1/grid.tif --session work/B1/session.sqlite --solution "
                        "work/B1/solution.sqlite --features control/features.csv --output work/B1/features.sqlite");
  std::filesystem::path map_file;
  std::filesystem::path session_file;
  std::filesystem::path solution_file;
  std::filesystem::path list_file;
  std::filesystem::path output;
  survey::LocateOptions options;
  double max_range_m = survey::RenderOptions{}.max_range_m;
  stage.Input("map", &map_file, "map of the block");
  stage.Input("session", &session_file, "session of the block");
  stage.Input("solution", &solution_file, "its solution, by which the map was drawn");
  stage.Input("features", &list_file, "list of the features with their surveyed coordinates",
              pipeline::Content::kTextWithoutComments);
  stage.Output("output", &output, "features.sqlite to write");
  stage.Option("search-radius-m", &options.search_radius_m, "features are looked for this far from their place (m)",
               {.min = 0.05, .max = 5.0});
  stage.Option("certain-m", &options.certain_m,
               "what is found farther from its place may be something else and is not taken (m)",
               {.min = 0.02, .max = 5.0});
  stage.Option("face-length-m", &options.face_length_m, "wall faces are followed this far from a corner (m)",
               {.min = 0.2, .max = 10.0});
  stage.Option("max-range-m", &max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const std::vector<survey::NamedFeature> wanted = formats::ReadFeaturesCsv(list_file);
    formats::RasterLabel label;
    const survey::SiteRaster map = formats::ReadRaster(map_file, &label);
    const formats::PosedSession block = formats::ReadPosedSession(session_file, solution_file);
    const survey::HitCells hits = HitsNear(wanted, map, block, options.Reach(), max_range_m);
    std::vector<survey::MapFeature> features;
    for (const survey::NamedFeature& one : wanted) {
      if (label.tied) {
        features.push_back(survey::LocateFeature(map, hits, one, options));
      } else {  // site coordinates mean nothing in a local frame
        features.push_back({.name = one.name, .kind = one.kind, .reason = "the map is not tied to control"});
      }
    }
    survey::RefuseSharedPlaces(kSamePlace_m, &features);
    for (survey::MapFeature& feature : features) AddPoses(block.solution, &feature);
    const auto found = std::count_if(features.begin(), features.end(), [](const auto& each) { return each.found; });
    formats::WriteFeatures(output, features, run.Provenance());
    run.Message(std::to_string(found) + " of " + std::to_string(wanted.size()) + " features found");
  });
}
