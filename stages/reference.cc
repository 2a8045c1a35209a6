// SPDX-License-Identifier: Apache-2.0
//
// A terrestrial scanner's cloud in the control frame: sphere targets found and matched to their coordinates, the cloud
// brought over, sliced to a plane reference, and the features of a list read in it.
#include <algorithm>
#include <cstdio>

#include "formats/cloud_file.h"
#include "formats/features_csv.h"
#include "formats/reference_file.h"
#include "formats/targets_csv.h"
#include "pipeline/stage.h"
#include "survey/cloud/slice.h"
#include "survey/cloud/sphere_targets.h"
#include "survey/features/reference_feature.h"

namespace {

struct ReferenceFiles {
  std::filesystem::path cloud, targets, features, output;
};

survey::TargetFit FitCloud(const ReferenceFiles& files, const survey::TargetFitOptions& options) {
  const formats::TargetList list = formats::ReadTargetsCsv(files.targets);
  std::vector<Eigen::Vector3f> cloud;
  formats::ReadCloud(files.cloud, [&](const Eigen::Vector3d& p) { cloud.push_back(p.cast<float>()); });
  std::vector<Eigen::Vector3d> centres;
  for (const auto& sphere : survey::FindSpheres(cloud, {.radius_m = list.radius_m})) centres.push_back(sphere.centre);
  survey::TargetFit fit = survey::FitTargets(centres, list.targets, options);
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
  const double placed = fit.rms_m * fit.rms_m / (3.0 * static_cast<double>(fit.residuals.size()));
  for (const survey::NamedFeature& wanted : formats::ReadFeaturesCsv(files.features)) {
    features.push_back(survey::LocateInReference(points, wanted, {}));
    features.back().covariance += Eigen::Matrix2d::Identity() * placed;
  }
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
  stage.Input("cloud", &files.cloud, "cloud of the scanner (PLY, PCD), m");
  stage.Input("targets", &files.targets, "sphere targets with their coordinates (CSV)",
              pipeline::Content::kTextWithoutComments);
  stage.OptionalInput("features", &files.features, "features to read, with rough coordinates (CSV)",
                      pipeline::Content::kTextWithoutComments);
  stage.Output("output", &files.output, "folder for reference.json, slice.ply and features.csv");
  stage.Option("slice-from-m", &from_m, "lowest elevation of the slice, site heights (m); needed");
  stage.Option("slice-to-m", &to_m, "highest elevation of the slice (m); needed");
  stage.Option("thin-to-m", &slice.cell_m, "one point is left in each square of this size (m)",
               {.min = 0.001, .max = 1});
  stage.Option("target-tolerance-m", &fit_options.tolerance_m, "targets must fit to this (m)",
               {.min = 0.001, .max = 1});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    if (!from_m || !to_m || *from_m >= *to_m) {
      throw formats::UsageError("--slice-from-m and --slice-to-m must be given, the first one below the second");
    }
    slice.from_elevation_m = *from_m;
    slice.to_elevation_m = *to_m;
    const survey::TargetFit fit = FitCloud(files, fit_options);
    const std::vector<Eigen::Vector2d> points = Slice(files, fit, slice);
    if (points.empty()) throw formats::DataError(files.cloud.string() + ": no point lies in the slice of heights");
    const std::vector<survey::MapFeature> features = ReadFeatures(files, fit, points);
    formats::WriteSlice(files.output / "slice.ply", points);
    formats::WriteReferenceFeatures(files.output / "features.csv", features);
    formats::WriteReferenceReport(files.output / "reference.json", fit, features, run.Provenance());
    run.Message(Summary(fit, features));
  });
}
