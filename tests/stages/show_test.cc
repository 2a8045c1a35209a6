// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <sstream>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "tests/support/command.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace {

using test_support::CommandResult;
using test_support::RandomArtefacts;
using test_support::RunCommand;
using test_support::ScratchFolder;

TEST(Show, EveryKindOfArtefactAsText) {
  const ScratchFolder folder;
  for (const auto& artefact : test_support::SmallArtefacts(31)) {
    const std::string file = folder / (artefact.name + ".sqlite");
    artefact.write(file);
    const CommandResult result = RunCommand({"plumbline-show", file});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_TRUE(result.out.starts_with(file + ": " + artefact.name + ", format version ")) << result.out;
    EXPECT_NE(result.out.find("\nmade by stage2 0.1.0, record "), std::string::npos);
    EXPECT_NE(result.out.find("\nfrom stage0 0.1.0, record "), std::string::npos);
    for (const char c : result.out) ASSERT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20);
  }
}

survey::Track TrackOfThree() {
  survey::Track track;
  track.scans = {{.scan = {0}, .local_from_scan = {1.25, -2.0, 0.0}},
                 {.scan = {1}, .local_from_scan = {500123.123456, 5600200.654321, 3.0}},
                 {.scan = {2}, .local_from_scan = {0.0, 0.0, -1.0}}};
  return track;
}

TEST(Show, TumTrajectoryIsExactAndOrderedByTheRecordedStamps) {
  const ScratchFolder folder;
  const std::string file = folder / "track.sqlite";
  // The logger's clock went back before the third scan.
  const std::vector<survey::ScanStamp> stamps = {{1'600'000'000'000'000'007, 1'600'000'000'000'000'007},
                                                 {1'600'000'000'123'456'789, 1'600'000'000'123'456'789},
                                                 {1'600'000'000'200'000'000, 1'600'000'000'000'000'001}};
  formats::WriteTrack(file, TrackOfThree(), stamps, RandomArtefacts(1).Provenance(0));
  const CommandResult result = RunCommand({"plumbline-show", file, "--trajectory", "tum"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out,
            "1600000000.000000001 0.000000000 0.000000000 0 0 0 -0.479425538604 0.877582561890\n"
            "1600000000.000000007 1.250000000 -2.000000000 0 0 0 0.000000000000 1.000000000000\n"
            "1600000000.123456789 500123.123456000 5600200.654321000 0 0 0 0.997494986604 0.070737201668\n");
}

TEST(Show, TumTrajectoryOfASolutionIsInTheSiteFrame) {
  const ScratchFolder folder;
  const std::string file = folder / "solution.sqlite";
  RandomArtefacts random(32);
  const survey::Solution solution = random.Solution(20);
  formats::WriteSolution(file, solution, random.ScanStamps(20), random.Provenance(0));
  std::istringstream lines(RunCommand({"plumbline-show", file, "--trajectory", "tum"}).out);
  int count = 0;
  double t, x, y, z, qx, qy, qz, qw;
  while (lines >> t >> x >> y >> z >> qx >> qy >> qz >> qw) {
    const survey::Pose2& pose = solution.scans[static_cast<std::size_t>(count++)].site_from_scan;
    EXPECT_NEAR(x, pose.x, 1e-8);
    EXPECT_NEAR(y, pose.y, 1e-8);
    EXPECT_NEAR(survey::NormalizeAngle(2.0 * std::atan2(qz, qw) - pose.theta), 0.0, 1e-11);
  }
  EXPECT_EQ(count, 20);
}

TEST(Show, TrajectoryOfAnotherArtefactIsRefused) {
  const ScratchFolder folder;
  const std::string file = folder / "loops.sqlite";
  formats::WriteLoops(file, {}, RandomArtefacts(33).Provenance(0));
  const CommandResult result = RunCommand({"plumbline-show", file, "--trajectory", "tum"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "plumbline-show: " + file +
                            ": a loops file has no trajectory; --trajectory works on track.sqlite and "
                            "solution.sqlite\n");
  EXPECT_EQ(RunCommand({"plumbline-show", file, "--trajectory", "kitti"}).status, 2);
}

TEST(Show, ControlInMillimetres) {
  const ScratchFolder folder;
  const std::string file = folder / "control.sqlite";
  survey::ControlNetwork network;
  network.points = {{.name = "P 1",
                     .position_in_site = {500000.1234, 5600000.5},
                     .covariance = Eigen::Vector2d(4e-6, 9e-6).asDiagonal()}};
  formats::WriteControl(file, network, RandomArtefacts(34).Provenance(0));
  const std::string out = RunCommand({"plumbline-show", file}).out;
  EXPECT_TRUE(std::regex_search(out, std::regex("P 1 +control +500000.1234 +5600000.5000 +2.0 +3.0 "))) << out;
}

TEST(Show, JsonIsIndented) {
  const ScratchFolder folder;
  const std::string file = folder / "seams.json";
  formats::WriteFileAtomically(file, R"({"b":[1,2.5],"a":null})");
  EXPECT_EQ(RunCommand({"plumbline-show", file}).out, "{\n  \"b\": [\n    1,\n    2.5\n  ],\n  \"a\": null\n}\n");
  formats::WriteFileAtomically(file, R"({"b":[1,2.5)");
  EXPECT_EQ(RunCommand({"plumbline-show", file}).err, "plumbline-show: " + file + ": not valid JSON (truncated?)\n");
}

TEST(Show, DamagedAndForeignFilesAreRefused) {
  const ScratchFolder folder;
  const std::string file = folder / "x.sqlite";
  EXPECT_EQ(RunCommand({"plumbline-show", file}).status, 1);
  EXPECT_EQ(RunCommand({"plumbline-show"}).status, 2);
  formats::WriteFileAtomically(file, "point,start,end\n");
  EXPECT_EQ(RunCommand({"plumbline-show", file}).err,
            "plumbline-show: " + file + ": not an artefact (neither SQLite, GeoTIFF nor JSON)\n");
}

TEST(Show, AFullDiskIsNoSuccess) {
  const ScratchFolder folder;
  const std::string file = folder / "track.sqlite";
  RandomArtefacts random(35);
  formats::WriteTrack(file, random.Track(2000), random.ScanStamps(2000), random.Provenance(0));
  const CommandResult result = RunCommand({"sh", "-c", "plumbline-show " + file + " --trajectory tum > /dev/full"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "plumbline-show: standard output: could not be written\n");
  // A reader that goes away ends it by SIGPIPE, or where that is ignored by the same message.
  EXPECT_NE(RunCommand({"bash", "-c", "plumbline-show " + file + " | true; exit ${PIPESTATUS[0]}"}).status, 0);
  EXPECT_EQ(
      RunCommand({"bash", "-c", "trap '' PIPE; plumbline-show " + file + " | true; exit ${PIPESTATUS[0]}"}).status, 1);
}

}  // namespace
