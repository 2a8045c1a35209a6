// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_config.h"

#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "pipeline/nearest.h"
#include "pipeline/site_layout.h"
#include "pipeline/site_template.h"
#include "tests/support/scratch_folder.h"

namespace {

using pipeline::ConfigSlices;

class SiteConfigTest : public testing::Test {
 protected:
  std::map<std::string, std::string> Slices(const std::string& site, const std::string& block) {
    formats::WriteFileAtomically(scratch_ / "site.toml", site);
    formats::WriteFileAtomically(scratch_ / "block.toml", block);
    return ConfigSlices(scratch_ / "site.toml", scratch_ / "block.toml", stages_);
  }

  // Keys and values of a slice, without its comments.
  static std::string Values(const std::string& slice) {
    std::istringstream lines(slice);
    std::string values;
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("#")) values += line + ";";
    }
    return values;
  }

  std::string ErrorOf(const std::string& site, const std::string& block) {
    try {
      Slices(site, block);
    } catch (const formats::UsageError& error) {
      return error.what();
    }
    return "";
  }

  pipeline::GraphStages stages_ = {
      .of_blocks = {{"ingest", "aa", {{"sigma-m", "number", "0.03", "0.001", "1", {}, "noise"}}},
                    {"track",
                     "bb",
                     {{"nodes", "integer", "80", "2", "", {}, "scans of a submap"},
                      {"engine", "string", "steam", "", "", {"steam", "diesel"}, "how"}}},
                    {"grid", "cc", {{"cell-size-m", "number", "0.05", "", "", {}, "cell"}}}},
      .of_site = {{"network",
                   "dd",
                   {{"crs", "string", "", "", "", {}, "system"},
                    {"control-order", "string", "", "", "", {"", "pnezd"}, "order"}}}}};
  test_support::ScratchFolder scratch_;
};

TEST_F(SiteConfigTest, EachStageGetsItsKeysAndBlocksReplaceThem) {
  const auto slices = Slices("[site]\ncell-size-m = 0.1\n[sensors]\nsigma-m = 0.02\n[track]\nnodes = 90\n",
                             "[sensors]\nsigma-m = 0.01\n[track]\nengine = \"diesel\"\n");
  EXPECT_EQ(slices.size(), 3U);
  EXPECT_EQ(Values(slices.at("ingest")), "sigma-m = 0.01;");
  EXPECT_EQ(Values(slices.at("track")), "engine = 'diesel';nodes = 90;");
  EXPECT_EQ(Values(slices.at("grid")), "cell-size-m = 0.1;");
}

TEST_F(SiteConfigTest, OtherKeysCommentsAndOrderLeaveASliceAsItIs) {
  const auto before = Slices("[track]\nnodes = 90\nengine = \"steam\"\n", "");
  const auto after =
      Slices("# remark\n[grid]\ncell-size-m = 0.2\n\n[track]\nengine = \"steam\"\nnodes = 90  # many\n", "");
  EXPECT_EQ(after.at("track"), before.at("track"));
  EXPECT_NE(after.at("grid"), before.at("grid"));
}

TEST_F(SiteConfigTest, AnotherBuildOfAProgramIsAnotherSlice) {
  const auto before = Slices("", "");
  stages_.of_blocks[1].identity = "b2";
  const auto after = Slices("", "");
  EXPECT_EQ(after.at("ingest"), before.at("ingest"));
  EXPECT_NE(after.at("track"), before.at("track"));
}

TEST_F(SiteConfigTest, MistakesAreToldWithFileAndLine) {
  EXPECT_NE(ErrorOf("[trak]\n", "").find("site.toml:1: [trak]: unknown table; did you mean track?"), std::string::npos);
  EXPECT_NE(ErrorOf("\nnodes = 3\n", "").find("site.toml:2: nodes: a key outside of any table"), std::string::npos);
  EXPECT_NE(ErrorOf("[track]\nnode = 3\n", "").find("site.toml:2: [track] node: unknown key; did you mean nodes?"),
            std::string::npos);
  EXPECT_NE(ErrorOf("[track]\nnodes = 1\n", "").find("site.toml:2: [track] nodes: must be at least 2"),
            std::string::npos);
  EXPECT_NE(ErrorOf("[track]\nnodes = 2.5\n", "").find("expected a value of type integer"), std::string::npos);
  EXPECT_NE(
      ErrorOf("", "[track]\nengine = \"petrol\"\n").find("block.toml:2: [track] engine: \"petrol\" must be one of"),
      std::string::npos);
  EXPECT_NE(ErrorOf("", "[network]\n").find("block.toml:1: [network]: unknown table"), std::string::npos);
  EXPECT_NE(ErrorOf("[track\n", "").find("site.toml:1: "), std::string::npos);
}

// What `new` writes must be accepted, also with every comment sign in front of a key taken away.
TEST_F(SiteConfigTest, NewSiteTomlHoldsOnlyKeysThatExist) {
  const std::string text = pipeline::SiteToml("EPSG:25832", "pnezd", stages_);
  EXPECT_EQ(ErrorOf(text, pipeline::BlockToml("B1", stages_)), "");
  std::string uncommented;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool key = line.starts_with("# ") && line.find(" = ") != std::string::npos;
    uncommented += (key ? line.substr(2) : line) + "\n";
  }
  EXPECT_EQ(ErrorOf(uncommented, ""), "");
  for (const char* key :
       {"sigma-m = 0.03", "nodes = 80", "cell-size-m = 0.05", "crs = \"EPSG:25832\"", "control-order = \"pnezd\""}) {
    EXPECT_NE(uncommented.find(key), std::string::npos) << key;
  }
}

TEST(SiteLayoutTest, NamesThatMakeCannotHandleAreRefused) {
  for (const char* good : {"B1", "2nd-floor", "west_wing"}) EXPECT_NO_THROW(pipeline::CheckBlockName(good, {"track"}));
  for (const char* bad : {"", "a b", "track", "all", "work", "-x", "a/b", "a=b", "a.b"}) {
    EXPECT_THROW(pipeline::CheckBlockName(bad, {"track"}), formats::UsageError) << bad;
  }
  EXPECT_TRUE(pipeline::IsPlainName("2024-05-17_run+1.log"));
  EXPECT_TRUE(pipeline::IsPlainName("Erdgeschoß.log"));
  for (const char* bad : {"a b.log", "a$b", "a#b", "a:b", "x(1).log", "a%b"}) EXPECT_FALSE(pipeline::IsPlainName(bad));
}

TEST(NearestTest, FindsWhatWasMeant) {
  EXPECT_EQ(pipeline::Nearest("trakc", {"grid", "track", "stitch"}), "track");
  EXPECT_EQ(pipeline::Nearest("zebra", {"grid", "track"}), "");
}

}  // namespace
