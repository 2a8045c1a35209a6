// SPDX-License-Identifier: Apache-2.0
//
// What `plumbline new`, `run` and `status` say and leave behind when they are used wrongly, and the sites with less
// than everything.
#include <gtest/gtest.h>

#include <fstream>

#include "formats/atomic_file.h"
#include "tests/support/job_site.h"
#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;
using test_support::CommandResult;
using test_support::RunCommand;
using test_support::ScratchFolder;

CommandResult Plumbline(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "plumbline");
  return RunCommand(arguments);
}

void ExpectRefused(const std::vector<std::string>& arguments, int status, const std::string& message) {
  const CommandResult result = Plumbline(arguments);
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
}

TEST(FrontCommandTest, HelpAndUnknownCommands) {
  const CommandResult help = Plumbline({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* word : {"plumbline new", "plumbline run", "plumbline status", "Example:"}) {
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
  }
  ExpectRefused({"trakc"}, 2, "trakc: no such command; did you mean track?");
  ExpectRefused({"rum"}, 2, "did you mean run?");
  ExpectRefused({"track"}, 2, "plumbline-track: ");
  ExpectRefused({"run", "nowhere"}, 2, "nowhere: no such folder");
  ExpectRefused({"status", "/tmp"}, 2, "it is not a site");
}

// GDAL takes longer to load than many a stage runs: those that read and write no raster do without it.
TEST(FrontCommandTest, ProgramsLoadWhatTheyUse) {
  const auto loads_gdal = [](const std::string& program) {
    return formats::ReadWholeFile(test_support::BinFolder() / program).find("libgdal.so") != std::string::npos;
  };
  for (const char* program :
       {"plumbline", "plumbline-ingest", "plumbline-track", "plumbline-loops", "plumbline-adjust"})
    EXPECT_FALSE(loads_gdal(program)) << program;
  EXPECT_TRUE(loads_gdal("plumbline-grid"));
}

TEST(FrontCommandTest, NewRefusesBadRequestsAndLeavesNothing) {
  const ScratchFolder scratch;
  const fs::path& field = test_support::FieldDataOfTwoRooms();
  const std::string site = scratch / "site";
  const std::string block = "A=" + (field / "blocks/A").string();
  std::ofstream(scratch / "pnezd.csv") << "1,5600201.9973,500101.9980,112.4,nail\n";
  std::ofstream(scratch / "two words.log") << "x\n";
  ExpectRefused({"new", site}, 2, "--block NAME=FILE is required");
  ExpectRefused({"new", site, "--block", "A"}, 2, "expected NAME=FILE");
  ExpectRefused({"new", site, "--block", block, "--block", block}, 2, "given twice");
  ExpectRefused({"new", site, "--block", "track=" + scratch.path().string()}, 2, "has a meaning for `make`");
  ExpectRefused({"new", site, "--block", "A=" + scratch.path().string()}, 1, "");
  ExpectRefused({"new", site, "--block", "A=/nowhere.log"}, 1, "/nowhere.log: no such file");
  ExpectRefused({"new", site, "--block", "A=" + (scratch / "two words.log").string()}, 1, "rename it");
  ExpectRefused({"new", site, "--block", block, "--crs", "EPSG:1"}, 2, "EPSG:1");
  ExpectRefused({"new", site, "--block", block, "--control", scratch / "pnezd.csv"}, 1, "pnezd.csv");
  EXPECT_FALSE(fs::exists(site));
  EXPECT_EQ(
      Plumbline({"new", site, "--block", block, "--control", scratch / "pnezd.csv", "--control-order", "pnezd"}).status,
      0);
  EXPECT_NE(formats::ReadWholeFile(site + "/site.toml").find("\ncontrol-order = \"pnezd\""), std::string::npos);
  ExpectRefused({"new", site, "--block", block}, 2, "exists already and is not overwritten");
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".tmp")) << entry.path();
  }
}

TEST(FrontCommandTest, LinkedFilesAndAVanishedOne) {
  const ScratchFolder scratch;
  const std::string site = scratch / "site";
  fs::copy(test_support::FieldDataOfTwoRooms() / "blocks/A", scratch / "field");
  ASSERT_EQ(Plumbline({"new", site, "--link", "--block", "A=" + (scratch / "field").string() + "/"}).status, 0);
  EXPECT_TRUE(fs::is_symlink(site + "/blocks/A/raw/scans.csv"));
  EXPECT_EQ(Plumbline({"run", site, "ingest"}).out, "A ingest\n");
  fs::remove(scratch / "field/imu.csv");
  ExpectRefused({"run", site}, 1, "blocks/A/raw/imu.csv: the linked file does not exist");
}

// Without control, and without marks, a block is mapped in its local frame and never certified.
TEST(FrontCommandTest, BlockWithoutControl) {
  const ScratchFolder scratch;
  const std::string site = scratch / "site";
  fs::create_directories(scratch / "field");
  fs::copy(test_support::FieldDataOfTwoRooms() / "blocks/A/scans.csv", scratch / "field");
  ASSERT_EQ(Plumbline({"new", site, "--block", "A=" + (scratch / "field").string()}).status, 0);
  const CommandResult run = Plumbline({"run", site, "-j2"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("not tied to control"), std::string::npos) << run.err;
  EXPECT_TRUE(fs::exists(site + "/out/site.tif"));
  EXPECT_TRUE(fs::exists(site + "/out/certificate.html"));
  EXPECT_EQ(Plumbline({"run", site}).out, "");
}

// One block of two has no marks: it is delivered apart.
TEST(FrontCommandTest, OneBlockWithoutMarks) {
  const test_support::JobSite site;
  fs::remove(site / "blocks/B/marks.csv");
  const CommandResult run = site.Run({"-j2"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::exists(site / "out/local/B.tif"));
  EXPECT_EQ(site.StagesOfRun(), std::vector<std::string>{});
  fs::remove(site / "out/local/B.tif");
  EXPECT_EQ(site.StagesOfRun(), std::vector<std::string>{"stitch"});
}

TEST(FrontCommandTest, StatusExplains) {
  const test_support::JobSite site = test_support::JobSite::Processed();
  EXPECT_TRUE(Plumbline({"status", site.path()}).out.ends_with("17 of 17 stage runs are up to date\n"));
  test_support::AppendToFile(site / "blocks/A/block.toml", "[loops]\nreach-m = 7\n");
  fs::remove(site / "work/B/grid.tif");
  const std::string status = Plumbline({"status", site.path()}).out;
  for (const char* line : {"A track   done\n", "A loops   stale: option reach-m: 7, was not given\n",
                           "A adjust  waiting for A loops\n", "B grid    stale: work/B/grid.tif is missing\n",
                           "a run does: A loops, B grid\n", "and where that brings new results: A adjust, A grid,"}) {
    EXPECT_NE(status.find(line), std::string::npos) << line << status;
  }
  EXPECT_EQ(site.Run({"-j2"}).status, 0);
  test_support::ReplaceInFile(site / "blocks/A/block.toml", "reach-m = 7", "reach-m = 8");
  test_support::AppendToFile(site / "control/points.csv", "# looked over on Friday\n");
  fs::remove_all(site / "blocks/B");
  const std::string later = Plumbline({"status", site.path()}).out;
  for (const char* line : {"A loops   stale: option reach-m: 8, was 7\n", "; control/points.csv changed\n",
                           "network   stale: no longer with B="}) {
    EXPECT_NE(later.find(line), std::string::npos) << line << later;
  }
}

}  // namespace
