// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/features_csv.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::ScratchFolder;

const char* const kHeader = "name,northing,easting,sigma_n,sigma_e,kind\n";

std::vector<survey::NamedFeature> Read(const std::string& text) {
  const ScratchFolder scratch;
  WriteFileAtomically(scratch / "features.csv", text);
  return ReadFeaturesCsv(scratch / "features.csv");
}

TEST(ReadFeaturesCsv, EastingIsX) {
  const auto features = Read(std::string(kHeader) +
                             "# by the door\nA1,5600000.5,500000.25,0.002,0.003,corner\n"
                             "P,5600001,500002,0,0,pillar\n");
  ASSERT_EQ(features.size(), 2U);
  EXPECT_EQ(features[0].name, "A1");
  EXPECT_EQ(features[0].position_in_site, Eigen::Vector2d(500000.25, 5600000.5));
  EXPECT_DOUBLE_EQ(features[0].covariance(0, 0), 9e-6);
  EXPECT_DOUBLE_EQ(features[0].covariance(1, 1), 4e-6);
  EXPECT_EQ(features[1].kind, survey::FeatureKind::kPillar);
}

TEST(ReadFeaturesCsv, MistakesAreNamed) {
  const std::string good = std::string(kHeader) + "A,1,2,0.1,0.1,corner\n";
  const struct {
    std::string text;
    std::string expected;
  } cases[] = {{"name,easting\n", "features.csv:1"},
               {good + "B,1,2,0.1,0.1,tree\n", "features.csv:3: kind = \"tree\": must be corner or pillar"},
               {good + "B,1,2,-0.1,0.1,corner\n", "sigma_n = \"-0.1\": a sigma must not be negative"},
               {good + "A,1,2,0.1,0.1,corner\n", "name = \"A\": stands in row 2 too"},
               {good + "B,1,nan,0.1,0.1,corner\n", "features.csv:3: easting"},
               {good + "B,1,2,0.1\n", "features.csv:3"}};
  for (const auto& one : cases) {
    try {
      Read(one.text);
      ADD_FAILURE() << one.text << " was accepted";
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find(one.expected), std::string::npos) << error.what();
    }
  }
}

TEST(FeaturesFile, ComesBackWithItsReasons) {
  const ScratchFolder scratch;
  const Provenance provenance{.records = {{.stage = "features", .version = "1", .options = {}, .inputs = {}}}};
  std::vector<survey::MapFeature> features(2);
  features[0] = {.name = "A", .found = true, .position_in_site = {500000.125, 5600000.5}, .num_cells = 40};
  features[0].covariance << 1e-4, 2e-5, 2e-5, 3e-4;
  features[0].reading << 1e-6, -2e-7, -2e-7, 3e-6;
  features[1] = {.name = "B", .kind = survey::FeatureKind::kPillar, .reason = "no wall of the map lies near"};
  WriteFeatures(scratch / "features.sqlite", features, provenance);
  const auto read = ReadFeatures(scratch / "features.sqlite");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_TRUE(read[0].found);
  EXPECT_EQ(read[0].position_in_site, features[0].position_in_site);
  EXPECT_EQ(read[0].covariance, features[0].covariance);
  EXPECT_EQ(read[0].reading, features[0].reading);
  EXPECT_EQ(read[0].num_cells, 40);
  EXPECT_FALSE(read[1].found);
  EXPECT_EQ(read[1].kind, survey::FeatureKind::kPillar);
  EXPECT_EQ(read[1].reason, features[1].reason);
  EXPECT_EQ(ReadProvenance(scratch / "features.sqlite").Own().Id(), provenance.Own().Id());
}

}  // namespace
}  // namespace formats
