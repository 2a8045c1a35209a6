// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "survey/accuracy/certify.h"
#include "survey/stats/philox.h"
#include "tests/support/json_schema.h"
#include "tests/support/paths.h"
#include "tests/support/scratch_folder.h"

namespace {

survey::Certificate Example() {
  survey::CertifyInput input{
      .site = "garage", .network = {.frame = {.crs = "EPSG:25832", .wkt2 = "PROJCRS[]"}}, .class_m = 0.05};
  const Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() * 4e-6;
  input.network.points = {{.name = "C1", .covariance = covariance, .elevation_m = 3.25, .description = "nail"},
                          {.name = "K1", .role = survey::PointRole::kCheck, .position_in_site = {5, 5}},
                          {.name = "X1", .role = survey::PointRole::kExcluded, .reason = "disturbed"}};
  input.network.points[0].elevation_sigma_m = 0.004;
  input.network.adjustment = {.software = "Plumbline", .num_observations = 20, .degrees_of_freedom = 8, .scaled = true};
  input.network.remarks = {"reduced to the grid"};
  for (const int i : {0, 1, 2, 3}) {
    input.reference_features.push_back(
        {.name = "F" + std::to_string(i), .position_in_site = {10.0 * i, i * i * 1.0}, .covariance = covariance});
  }
  survey::Solution solution{.tied = true, .frame = input.network.frame};
  solution.marks = {{.point = "C1", .used = true, .residual = {0.001, 0.002}},
                    {.point = "K1", .position_in_site = {5.01, 5}}};
  solution.marks[0].test = survey::MarkTest{.redundancy = 0.4, .t = 3.0, .degrees_of_freedom = 1};
  solution.marks.push_back({.point = "C2", .left_out = "left out: 5 m away"});
  solution.marks.back().test =
      survey::MarkTest{.redundancy = 0.6, .t = 99.0, .detectable = 0.03, .largest_shift = 0.02};
  solution.components = {{"loop", 17, 32.1, 0.99}};
  solution.findings = {solution.marks.back().left_out};
  std::vector<survey::MapFeature> shifted, exact;
  for (const survey::NamedFeature& feature : input.reference_features) {
    const Eigen::Vector2d& p = feature.position_in_site;
    exact.push_back({.name = feature.name, .found = true, .position_in_site = p});
    shifted.push_back(exact.back());
    shifted.back().position_in_site += Eigen::Vector2d(0.01, 0.1 / 3.0 * p.x());
  }
  input.blocks = {{"B1", solution, shifted}, {"B2", solution, exact}};
  input.seams = {{.block_a = "B1", .block_b = "B2", .overlap_area_m2 = 12.5, .num_windows = 1, .rms = 0.01}};
  survey::Certificate certificate = survey::Certify(input);
  certificate.metric = "metres on the grid";
  certificate.cross_validation = survey::CrossValidation{
      .statistics = certificate.points_test.statistics, .normalised_square = 1.1, .sentence = "Cross-validated"};
  certificate.since_delivery = survey::CompareDeliveries(
      {.points = {{"C1", survey::PointRole::kControl, {1, 2}}}, .poses = {{"B1", 5, {1, 2}}, {"B2", 5, {1, 2}}}},
      {.points = {{"C1", survey::PointRole::kControl, {1, 2.01}}, {"K1", survey::PointRole::kCheck, {5, 5}}},
       .poses = {{"B1", 5, {1, 2.01}}}});
  certificate.joint = {.num_control_points = 2,
                       .num_shared = 1,
                       .blocks = {{.name = "B1", .rms_shift = 0.002, .max_shift = 0.004, .place_of_max = {7, 8}}},
                       .pairs = {{.block_a = "B1", .block_b = "B2", .num_matches = 9, .num_used = 8, .sigma = 0.01}},
                       .apart = {"B3"}};
  return certificate;
}

const formats::Provenance kProvenance = {.records = {{.stage = "certify", .version = "1"}}};

TEST(CertificateFileTest, ReadsBackWhatItWrote) {
  const test_support::ScratchFolder scratch;
  formats::WriteCertificate(scratch / "a.json", Example(), kProvenance);
  formats::Provenance provenance;
  const survey::Certificate read = formats::ReadCertificate(scratch / "a.json", &provenance);
  EXPECT_EQ(provenance.Own().stage, "certify");
  EXPECT_EQ(read.checks.at(1).error, Example().checks.at(1).error);
  formats::WriteCertificate(scratch / "b.json", read, kProvenance);
  EXPECT_EQ(formats::ReadWholeFile(scratch / "a.json"), formats::ReadWholeFile(scratch / "b.json"));
}

TEST(CertificateFileTest, FollowsItsSchema) {
  const test_support::ScratchFolder scratch;
  const nlohmann::json schema =
      nlohmann::json::parse(formats::ReadWholeFile(test_support::SourceFolder() / "formats/certificate.schema.json"));
  survey::Certificate untested;
  untested.blocks.push_back({.name = "B1"});
  for (const survey::Certificate& certificate : {Example(), survey::Certificate(), untested}) {
    formats::WriteCertificate(scratch / "a.json", certificate, kProvenance);
    nlohmann::json document = nlohmann::json::parse(formats::ReadWholeFile(scratch / "a.json"));
    EXPECT_EQ(test_support::SchemaViolation(schema, document), "");
    document["statement"].erase("asprs");
    EXPECT_NE(test_support::SchemaViolation(schema, document), "");
  }
}

TEST(CertificateFileTest, DamagedFilesAreRefusedOrRead) {
  const test_support::ScratchFolder scratch;
  formats::WriteCertificate(scratch / "a.json", Example(), kProvenance);
  const std::string whole = formats::ReadWholeFile(scratch / "a.json");
  const survey::RandomStream random(6, 0, 0);
  for (std::uint64_t i = 0; i < 300; ++i) {
    std::string text = whole;
    const auto bits = random.Bits(i);
    const std::size_t at = bits[0] % text.size();
    if (bits[1] % 4 == 0) {
      text.resize(at);
    } else {
      text[at] = "{}[],:\"9-null"[bits[2] % 13];
    }
    std::ofstream(scratch / "b.json", std::ios::binary) << text;
    try {
      formats::ReadCertificate(scratch / "b.json");
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find("b.json"), std::string::npos) << error.what();
    }
  }
}

TEST(CertificateFileTest, RefusesOtherFiles) {
  const test_support::ScratchFolder scratch;
  const auto refused = [&](const std::string& content) {
    formats::WriteFileAtomically(scratch / "a.json", content);
    EXPECT_THROW(formats::ReadCertificate(scratch / "a.json"), formats::DataError) << content;
  };
  refused("");
  refused("{\"format\": \"plumbline-cert");
  refused("[1, 2]");
  refused(R"({"format": "plumbline-certificate", "format_version": 99})");
  refused(R"({"format": "plumbline-certificate", "format_version": 3, "site": 7})");
}

}  // namespace
