// SPDX-License-Identifier: Apache-2.0
//
// Tests the blocks on what their adjustment never saw and writes the certificate. A class that is not met is a verdict,
// not a failure: the exit status is 0.
#include "survey/accuracy/certify.h"

#include <algorithm>
#include <cstdio>

#include "formats/accuracy_classes_file.h"
#include "formats/artefacts.h"
#include "formats/certificate_file.h"
#include "formats/delivery_csv.h"
#include "formats/features_csv.h"
#include "formats/joint_file.h"
#include "formats/requests_file.h"
#include "formats/seam_summary.h"
#include "formats/site_metric.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/edits/site_edits.h"

namespace {

using pipeline::NamedFile;

struct CertifyFiles {
  std::filesystem::path control;
  std::vector<NamedFile> solutions;
  std::vector<NamedFile> features;
  std::filesystem::path feature_list;
  std::filesystem::path seams;
  std::filesystem::path joint;
  std::filesystem::path requests;
  std::filesystem::path delivered_control, delivered_poses;
  std::filesystem::path classes;
  std::vector<NamedFile> edits;
  std::filesystem::path output;
};

std::filesystem::path SolutionOf(const std::string& block, const CertifyFiles& files) {
  const auto found = std::find_if(files.solutions.begin(), files.solutions.end(),
                                  [&](const NamedFile& solution) { return solution.name == block; });
  return found->file;
}

// Features of an older solution would test a map that is no longer delivered.
void RequireDescent(const NamedFile& features, const std::filesystem::path& solution) {
  const std::string id = formats::ReadProvenance(solution).Own().Id();
  const formats::Provenance chain = formats::ReadProvenance(features.file);
  const bool descends = std::any_of(chain.records.begin(), chain.records.end(),
                                    [&](const formats::ProvenanceRecord& record) { return record.Id() == id; });
  if (descends) return;
  throw formats::DataError(features.file.string() + ": was not measured in the map of " + solution.string() +
                           "; make it again with plumbline features");
}

void ReadReviews(const std::filesystem::path& requests, std::vector<survey::CertifiedBlock>* blocks) {
  for (const formats::ListedBlock& listed : formats::ReadReviewedBlocks(requests)) {
    for (survey::CertifiedBlock& block : *blocks) {
      if (block.name == listed.name) block.review = listed.review;
    }
  }
}

survey::CertifyInput ReadInput(const CertifyFiles& files) {
  survey::CertifyInput input;
  if (!files.control.empty()) input.network = formats::ReadControl(files.control);
  for (const NamedFile& solution : files.solutions) {
    if (std::any_of(input.blocks.begin(), input.blocks.end(),
                    [&](const survey::CertifiedBlock& block) { return block.name == solution.name; })) {
      throw formats::UsageError("--solution names block " + solution.name + " twice");
    }
    input.blocks.push_back({.name = solution.name, .solution = formats::ReadSolution(solution.file)});
  }
  if (!files.feature_list.empty()) input.reference_features = formats::ReadFeaturesCsv(files.feature_list);
  for (const NamedFile& features : files.features) {
    const auto block = std::find_if(input.blocks.begin(), input.blocks.end(),
                                    [&](const survey::CertifiedBlock& each) { return each.name == features.name; });
    if (block == input.blocks.end()) {
      throw formats::UsageError("--features names block " + features.name + ", --solution does not");
    }
    RequireDescent(features, SolutionOf(features.name, files));
    block->features = formats::ReadFeatures(features.file);
  }
  if (!files.requests.empty()) ReadReviews(files.requests, &input.blocks);
  if (!files.seams.empty()) input.seams = formats::ReadSeamSummaries(files.seams);
  return input;
}

// What the site rests on now, every scan.
survey::Delivery DeliveryNow(const CertifyFiles& files, const survey::CertifyInput& input) {
  survey::Delivery now{.points = formats::PointsOfDelivery(input.network), .poses = {}};
  for (const survey::CertifiedBlock& block : input.blocks) {
    const std::vector<survey::DeliveredPose> poses = formats::PosesOfDelivery(
        block.name, block.solution, formats::ReadScanStamps(SolutionOf(block.name, files)), 0.0);
    now.poses.insert(now.poses.end(), poses.begin(), poses.end());
  }
  return now;
}

std::optional<survey::DeliveryChanges> ChangesSinceDelivery(const CertifyFiles& files,
                                                            const survey::CertifyInput& input) {
  if (files.delivered_control.empty() != files.delivered_poses.empty()) {
    throw formats::UsageError("--delivered-control and --delivered-poses belong together");
  }
  if (files.delivered_control.empty()) return std::nullopt;
  const survey::Delivery before{.points = formats::ReadDeliveredControl(files.delivered_control),
                                .poses = formats::ReadDeliveredPoses(files.delivered_poses)};
  return survey::CompareDeliveries(before, DeliveryNow(files, input));
}

std::vector<survey::AccuracyClass> ReadClasses(const CertifyFiles& files, std::optional<double> class_m) {
  std::vector<survey::AccuracyClass> classes = formats::StandardAccuracyClasses(class_m);
  if (files.classes.empty()) return classes;
  for (const survey::AccuracyClass& each : formats::ReadAccuracyClasses(files.classes, class_m)) {
    classes.push_back(each);
  }
  return classes;
}

std::optional<survey::EditSummary> ReadEditSummary(const std::vector<NamedFile>& files) {
  const std::vector<survey::BlockEdits> blocks = pipeline::ReadBlockEdits(files);
  const bool any = std::any_of(blocks.begin(), blocks.end(), [](const auto& block) { return !block.edits.empty(); });
  return any ? std::optional(survey::SummarizeEdits(blocks)) : std::nullopt;
}

std::string Summary(const survey::Certificate& certificate) {
  if (!certificate.tied) return "no block is tied to control: nothing is certified";
  std::string text = "not tested: no checks";
  for (const auto& [name, test] :
       {std::pair{"check features", &certificate.features_test}, std::pair{"check points", &certificate.points_test}}) {
    if (test->statistics.num_points == 0) continue;
    char numbers[160];
    std::snprintf(numbers, sizeof numbers, "%s: RMSE_H %.1f mm (n = %d)", name, 1000.0 * test->statistics.rmse_product,
                  test->statistics.num_points);
    text = text.starts_with("not tested") ? numbers : text + "; " + numbers;
  }
  if (certificate.statement.meets) text += *certificate.statement.meets ? "; class met" : "; class NOT met";
  return text;
}

void Run(const CertifyFiles& files, survey::CertifyInput input, pipeline::StageRun& run) {
  const std::vector<std::string> contradictions = survey::FindContradictions(input);
  if (!contradictions.empty()) {
    std::string message = files.control.string();
    for (const std::string& contradiction : contradictions) message += (message.empty() ? "" : ": ") + contradiction;
    throw formats::DataError(message);
  }
  survey::Certificate certificate = survey::Certify(input);
  if (!files.joint.empty()) certificate.joint = formats::ReadJoint(files.joint);
  if (certificate.tied) certificate.metric = formats::MetricSentence(input.network);
  certificate.since_delivery = ChangesSinceDelivery(files, input);
  certificate.edits = ReadEditSummary(files.edits);
  formats::WriteCertificate(files.output, certificate, run.Provenance());
  run.Message(Summary(certificate));
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "certify", "Test the maps on independent checks and write the certificate.",
      "plumbline certify --control work/control.sqlite --solution B1=work/B1/solution.sqlite --features "
      "B1=work/B1/features.sqlite --feature-list control/features.csv --seams out/seams.json --output "
      "out/certificate.json");
  CertifyFiles files;
  std::string site_title = "Site";
  double class_m = 0.0;
  double centring_sigma_m = 0.005;
  double far_from_control_m = 30.0;
  stage.OptionalInput("control", &files.control, "control.sqlite of the site");
  stage.NamedInputs("solution", &files.solutions, "solution.sqlite of each block", true);
  stage.NamedInputs("features", &files.features, "features.sqlite of each block", false);
  stage.OptionalInput("feature-list", &files.feature_list, "surveyed coordinates of the check features (CSV)",
                      pipeline::Content::kTextWithoutComments);
  stage.OptionalInput("seams", &files.seams, "seams.json of the stitched site");
  stage.OptionalInput("joint", &files.joint, "joint.json, when the blocks were adjusted together");
  stage.OptionalInput("requests", &files.requests, "requests.jsonl of the site");
  stage.OptionalInput("delivered-control", &files.delivered_control, "control at the last delivery (CSV)",
                      pipeline::Content::kTextWithoutComments);
  stage.OptionalInput("delivered-poses", &files.delivered_poses, "the platform at the last delivery (CSV)",
                      pipeline::Content::kTextWithoutComments);
  stage.NamedInputs("edits", &files.edits, "edits.json of each block", false);
  stage.OptionalInput("classes", &files.classes, "further accuracy classes (TOML)",
                      pipeline::Content::kTextWithoutComments);
  stage.Output("output", &files.output, "certificate.json to write");
  stage.Option("site-title", &site_title, "title of the site on the certificate");
  stage.Option("accuracy-class-m", &class_m, "class to certify: largest RMSE_H (m); 0: none asked for",
               {.min = 0.0, .max = 100.0});
  stage.Option("check-centring-m", &centring_sigma_m, "1 sigma per axis of the platform over a check point (m)",
               {.min = 0.0, .max = 1.0});
  stage.Option("far-from-control-m", &far_from_control_m,
               "what was mapped farther than this from used control is named as not covered (m)",
               {.min = 1.0, .max = 10000.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    survey::CertifyInput input = ReadInput(files);
    input.site = site_title;
    input.centring_sigma_m = centring_sigma_m;
    input.far_from_control_m = far_from_control_m;
    if (class_m > 0.0) input.class_m = class_m;
    input.classes = ReadClasses(files, input.class_m);
    Run(files, std::move(input), run);
  });
}
