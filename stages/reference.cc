// SPDX-License-Identifier: Apache-2.0
//
// A terrestrial scanner's cloud in the control frame: spheres and checkerboards found and matched to their coordinates,
// the cloud brought over, sliced to a plane reference, and the features of a list read in it.
#include <algorithm>
#include <cstdio>

#include "formats/cloud_file.h"
#include "formats/cloud_tiles.h"
#include "formats/features_csv.h"
#include "formats/reference_file.h"
#include "formats/targets_csv.h"
#include "pipeline/stage.h"
#include "survey/cloud/checkerboard_targets.h"
#include "survey/cloud/slice.h"
#include "survey/cloud/sphere_targets.h"
#include "survey/features/locate.h"
#include "survey/features/reference_feature.h"

namespace {

constexpr double kSamePlace_m = 0.01;

struct ReferenceFiles {
  std::filesystem::path cloud, targets, features, output;
};

// Tile by tile: a cloud may be larger than memory.
std::vector<Eigen::Vector3d> FindTargets(const ReferenceFiles& files, const formats::TargetList& list,
                                         double board_size_m) {
  std::vector<Eigen::Vector3d> centres;
  const auto take = [&](const formats::CloudTile& tile, const Eigen::Vector3d& centre) {
    if (tile.Holds(centre)) centres.emplace_back(tile.origin + centre);
  };
  formats::ForEachTile(
      files.cloud, files.output / ".tiles", {.margin_m = 3.0 * std::max(list.radius_m, board_size_m)},
      [&](const formats::CloudTile& tile) {
        if (list.radius_m > 0.0) {
          for (const auto& sphere : survey::FindSpheres(tile.points, {.radius_m = list.radius_m}))
            take(tile, sphere.centre);
        }
        if (!list.has_boards) return;
        for (const auto& board : survey::FindBoards(tile.points, tile.intensities, {.size_m = board_size_m}))
          take(tile, board.centre);
      });
  return centres;
}

survey::TargetFit FitCloud(const ReferenceFiles& files, double board_size_m, const survey::TargetFitOptions& options) {
  const formats::TargetList list = formats::ReadTargetsCsv(files.targets);
  survey::TargetFit fit = survey::FitTargets(FindTargets(files, list, board_size_m), list.targets, options);
  if (!fit.usable)
    throw formats::DataError(files.cloud.string() + ": with " + files.targets.string() + ": " + fit.message);
  return fit;
}

std::vector<Eigen::Vector2d> Slice(const ReferenceFiles& files, const survey::TargetFit& fit,
                                   const survey::SliceOptions& options) {
  survey::CloudSlice slice(options);
  formats::ReadCloud(files.cloud, [&](const Eigen::Vector3d& p) { slice.Add(fit.site_from_cloud * p); });
  return slice.Points();
}

// The fit of the cloud adds to the sigma of each feature.
std::vector<survey::MapFeature> ReadFeatures(const ReferenceFiles& files, const survey::TargetFit& fit,
                                             const std::vector<Eigen::Vector2d>& points) {
  std::vector<survey::MapFeature> features;
  if (files.features.empty()) return features;
  for (const survey::NamedFeature& wanted : formats::ReadFeaturesCsv(files.features)) {
    features.push_back(survey::LocateInReference(points, wanted, {}));
    if (features.back().found) features.back().covariance += fit.CovarianceAt(features.back().position_in_site);
  }
  survey::RefuseSharedPlaces(kSamePlace_m, &features);
  return features;
}

std::string Summary(const survey::TargetFit& fit, const std::vector<survey::MapFeature>& features) {
  const auto found = std::count_if(features.begin(), features.end(), [](const auto& feature) { return feature.found; });
  char text[160];
  std::snprintf(text, sizeof text, "%zu targets, rms %.1f mm, scale %+.0f ppm; %td of %zu features found",
                fit.residuals.size(), 1000.0 * fit.rms_m, (fit.scale - 1.0) * 1e6, found, features.size());
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("reference",
                        "Bring a terrestrial scanner's cloud into the control frame and read features in it.",
                        "plumbline reference --cloud reference/cloud.ply --targets reference/targets.csv --features "
                        "rough.csv --slice-from-m 112.5 --slice-to-m 112.8 --output reference/out");
  ReferenceFiles files;
  survey::TargetFitOptions fit_options;
  survey::SliceOptions slice;
  std::optional<double> from_m, to_m;
  double board_size_m = 0.15;
  stage.Input("cloud", &files.cloud, "cloud of the scanner (PLY, PCD), m");
  stage.Input("targets", &files.targets, "spheres and checkerboards with their coordinates (CSV)",
              pipeline::Content::kTextWithoutComments);
  stage.OptionalInput("features", &files.features, "features to read, with rough coordinates (CSV)",
                      pipeline::Content::kTextWithoutComments);
  stage.Output("output", &files.output, "folder for reference.json, slice.ply and features.csv");
  stage.Option("slice-from-m", &from_m, "lowest elevation of the slice, site heights (m); needed");
  stage.Option("slice-to-m", &to_m, "highest elevation of the slice (m); needed");
  stage.Option("thin-to-m", &slice.cell_m, "one point is left in each square of this size (m)",
               {.min = 0.001, .max = 1});
  stage.Option("board-size-m", &board_size_m, "edge of the checkerboards (m)", {.min = 0.03, .max = 2});
  stage.Option("target-tolerance-m", &fit_options.tolerance_m, "targets must fit to this (m)",
               {.min = 0.001, .max = 1});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    if (!from_m || !to_m || *from_m >= *to_m) {
      throw formats::UsageError("--slice-from-m and --slice-to-m must be given, the first one below the second");
    }
    slice.from_elevation_m = *from_m;
    slice.to_elevation_m = *to_m;
    const survey::TargetFit fit = FitCloud(files, board_size_m, fit_options);
    const std::vector<Eigen::Vector2d> points = Slice(files, fit, slice);
    if (points.empty()) throw formats::DataError(files.cloud.string() + ": no point lies in the slice of heights");
    const std::vector<survey::MapFeature> features = ReadFeatures(files, fit, points);
    formats::WriteSlice(files.output / "slice.ply", points);
    formats::WriteReferenceFeatures(files.output / "features.csv", features);
    formats::WriteReferenceReport(files.output / "reference.json", fit, features, run.Provenance());
    run.Message(Summary(fit, features));
  });
}
