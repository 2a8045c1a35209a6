// SPDX-License-Identifier: Apache-2.0
//
// A campus of twelve blocks, by the real executables: one more block costs its own stages and those of the site, and
// a block comes out the same in a site of any size.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "tests/support/job_site.h"
#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;
using test_support::CommandResult;
using test_support::ReplaceInFile;
using test_support::RunCommand;

constexpr int kBlocks = 12;  // rooms in three rows of four

std::string NameOf(int block) {
  char name[8];
  std::snprintf(name, sizeof name, "K%03d", block);
  return name;
}

class CampusTest : public testing::Test {
 protected:
  // A coarse lidar, so that the test is short.
  CampusTest() {
    const CommandResult scenario =
        RunCommand({test_support::SourceFolder() / "scripts/campus", "scenario", std::to_string(kBlocks)});
    EXPECT_EQ(scenario.status, 0) << scenario.err;
    formats::WriteFileAtomically(scratch_ / "campus.toml", scenario.out);
    ReplaceInFile(scratch_ / "campus.toml", "rate-hz = 10\n", "rate-hz = 5\n");
    ReplaceInFile(scratch_ / "campus.toml", "beams = 271\n", "beams = 181\n");
    Require({"plumbline-simulate", "--scenario", scratch_ / "campus.toml", "--output", scratch_ / "field", "--quiet"});
  }

  CommandResult Require(const std::vector<std::string>& command) const {
    CommandResult result = RunCommand(command);
    EXPECT_EQ(result.status, 0) << command.front() << ": " << result.err;
    return result;
  }

  fs::path FieldOf(int block) const { return scratch_ / "field" / "blocks" / NameOf(block); }

  void MakeSite(const std::string& site, const std::vector<int>& blocks) const {
    std::vector<std::string> command = {
        "plumbline", "new", scratch_ / site, "--crs", "EPSG:25832", "--control", scratch_ / "field/control/points.csv"};
    for (const int block : blocks) {
      command.emplace_back("--block");
      command.push_back(NameOf(block) + "=" + FieldOf(block).string());
    }
    Require(command);
    ReplaceInFile(scratch_ / site / "site.toml", "\n# cell-size-m = 0.05", "\ncell-size-m = 0.10");
  }

  // The stages that ran: "K001 track", "stitch".
  std::set<std::string> Run(const std::string& site, const std::string& target) const {
    std::istringstream lines(Require({"plumbline", "run", scratch_ / site, "-j2", target}).out);
    std::set<std::string> stages;
    for (std::string line; std::getline(lines, line);) stages.insert(line);
    return stages;
  }

  std::map<std::string, std::string> DigestsOf(const std::string& site, int block) const {
    std::map<std::string, std::string> digests;
    for (const fs::directory_entry& entry : fs::directory_iterator(scratch_ / site / "work" / NameOf(block))) {
      if (entry.is_regular_file()) digests[entry.path().filename()] = formats::Sha256OfFile(entry.path());
    }
    return digests;
  }

  const test_support::ScratchFolder scratch_;
};

TEST_F(CampusTest, OneMoreBlockCostsOneBlock) {
  std::vector<int> eleven;
  for (int block = 1; block < kBlocks; ++block) eleven.push_back(block);
  MakeSite("site", eleven);
  EXPECT_EQ(Run("site", "edit").size(), 6 * eleven.size() + 1);  // and the network
  const auto before = DigestsOf("site", 6);

  MakeSite("last", {kBlocks});
  fs::copy(scratch_ / "last/blocks" / NameOf(kBlocks), scratch_ / "site/blocks" / NameOf(kBlocks),
           fs::copy_options::recursive);
  EXPECT_EQ(Run("site", "stitch"), (std::set<std::string>{"K012 adjust", "K012 edit", "K012 grid", "K012 ingest",
                                                          "K012 loops", "K012 track", "network", "stitch"}));
  EXPECT_EQ(DigestsOf("site", 6), before);

  // By itself a block comes out as among eleven others.
  Run("last", "edit");
  const auto alone = DigestsOf("last", kBlocks);
  EXPECT_TRUE(alone.contains("map.tif") && alone.contains("solution.sqlite"));
  EXPECT_EQ(alone, DigestsOf("site", kBlocks));
}

}  // namespace
