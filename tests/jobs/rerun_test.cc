// SPDX-License-Identifier: Apache-2.0
//
// After each kind of change exactly the stages run that depend on it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "tests/support/job_site.h"
#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;
using test_support::AppendToFile;
using test_support::Differences;
using test_support::JobSite;
using test_support::ReplaceInFile;

using Stages = std::vector<std::string>;

class RerunTest : public testing::Test {
 protected:
  JobSite site_ = JobSite::Processed();
};

TEST_F(RerunTest, FirstRunDoesEverythingSecondIsSilent) {
  fs::remove_all(site_ / "work");
  EXPECT_EQ(site_.StagesOfRun(),
            (Stages{"A adjust", "A edit", "A grid", "A ingest", "A loops", "A track", "B adjust", "B edit", "B grid",
                    "B ingest", "B loops", "B track", "certify", "network", "report", "requests", "stitch"}));
  const test_support::CommandResult second = site_.Run();
  EXPECT_EQ(second.status, 0);
  EXPECT_EQ(second.out, "");
  EXPECT_EQ(second.err, "");
}

TEST_F(RerunTest, ControlChanges) {
  const fs::path points = site_ / "control/points.csv";
  AppendToFile(points, "# looked over on Friday\n");
  EXPECT_EQ(site_.StagesOfRun(), Stages{"network"});

  ReplaceInFile(points, "1,5600201.9973,", "1,5600201.9953,");  // block B has not seen point 1
  EXPECT_EQ(site_.StagesOfRun(),
            (Stages{"A adjust", "A edit", "A grid", "certify", "network", "report", "requests", "stitch"}));

  // An older version is put back with its old time stamp.
  ReplaceInFile(points, "1,5600201.9953,", "1,5600201.9973,");
  fs::last_write_time(points, fs::file_time_type::clock::now() - std::chrono::hours(1000));
  EXPECT_EQ(site_.StagesOfRun(),
            (Stages{"A adjust", "A edit", "A grid", "certify", "network", "report", "requests", "stitch"}));

  ReplaceInFile(points, "5600208.0000,500102.0004", "5600208.0000,500102.0024");  // a check point
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "network", "report"}));
}

// A delivery is noted; the next certificate says which point moved, and what the maps did.
TEST_F(RerunTest, DeliveryAndControlUpdate) {
  const auto deliver = [&] { return test_support::RunCommand({"plumbline", "deliver", site_.path()}); };
  EXPECT_EQ(deliver().status, 0);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "report"}));
  ReplaceInFile(site_ / "control/points.csv", "1,5600201.9973,", "1,5600201.9773,");  // 20 mm south
  const test_support::CommandResult early = deliver();
  EXPECT_EQ(early.status, 1);
  EXPECT_NE(early.err.find("network is not up to date"), std::string::npos) << early.err;
  EXPECT_EQ(site_.StagesOfRun(),
            (Stages{"A adjust", "A edit", "A grid", "certify", "network", "report", "requests", "stitch"}));
  const auto changes = nlohmann::json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"))["since_delivery"];
  ASSERT_EQ(changes["control"].size(), 1);
  EXPECT_EQ(changes["control"][0]["name"], "1");
  EXPECT_NEAR(changes["control"][0]["shift"]["n"], -0.020, 1e-5);
  const double followed = changes["control"][0]["map_shift"]["n"];
  EXPECT_LT(followed, -0.003);
  EXPECT_GT(followed, -0.020);
  EXPECT_GT(changes["blocks"][0]["max_shift"], 0.003);
  EXPECT_LT(changes["blocks"][1]["max_shift"], 2e-5);  // block B has not seen it
  EXPECT_NE(formats::ReadWholeFile(site_ / "out/certificate.html").find("Changes since the last delivery"),
            std::string::npos);
}

TEST_F(RerunTest, OptionsOfOneStage) {
  ReplaceInFile(site_ / "site.toml", "# seam-window-m = 8 ", "seam-window-m = 7");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "report", "stitch"}));

  AppendToFile(site_ / "blocks/A/block.toml", "[grid]\nmax-range-m = 25\n");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A edit", "A grid", "certify", "report", "requests", "stitch"}));

  AppendToFile(site_ / "site.toml", "# a remark\n");
  EXPECT_EQ(site_.StagesOfRun(), Stages{});
}

// plumbline-join by hand on the files of a site with the blocks A and B.
test_support::CommandResult Join(const JobSite& site, const std::string& graph_of_b) {
  std::vector<std::string> command = {"plumbline-join", "--control", "work/joint-control.sqlite"};
  for (const std::string file : {"session", "track"})
    command.insert(command.end(), {"--" + file, "A=work/A/" + file + ".sqlite", "B=work/B/" + file + ".sqlite"});
  command.insert(command.end(),
                 {"--graph", "A=work/A/graph.sqlite", graph_of_b, "--solution", "A=work/A/adjusted.sqlite",
                  "B=work/B/adjusted.sqlite", "--output", "by-hand", "--report", "by-hand/joint.json"});
  return test_support::RunCommand(command, site.path());
}

void ExpectJoinChecksItsInputs(const JobSite& site) {
  const test_support::CommandResult foreign = Join(site, "B=work/A/graph.sqlite");
  EXPECT_EQ(foreign.status, 1);
  EXPECT_NE(foreign.err.find("was not written by the run of adjust that wrote work/B/adjusted.sqlite"),
            std::string::npos)
      << foreign.err;
  const test_support::CommandResult missing = Join(site, "C=work/B/graph.sqlite");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("--graph B=FILE is missing"), std::string::npos) << missing.err;
  EXPECT_FALSE(fs::exists(site / "by-hand"));
  // Without --joint every block keeps its own solution.
  EXPECT_EQ(Join(site, "B=work/B/graph.sqlite").status, 0);
  const survey::Solution kept = formats::ReadSolution(site / "by-hand/B/solution.sqlite");
  const survey::Solution own = formats::ReadSolution(site / "work/B/adjusted.sqlite");
  EXPECT_EQ(kept.scans.back().site_from_scan.Vector(), own.scans.back().site_from_scan.Vector());
}

// All blocks together: a moved control point moves the blocks that did not see it too; a check point moves none.
TEST_F(RerunTest, JointAdjustment) {
  const auto apart = site_.Results();
  ReplaceInFile(site_ / "site.toml", "# joint = false", "joint = true");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A adjust", "A edit", "A grid", "B adjust", "B edit", "B grid", "certify",
                                         "join", "network", "report", "requests", "stitch"}));
  EXPECT_EQ(site_.StagesOfRun(), Stages{});
  const auto joint = nlohmann::json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"))["joint"];
  EXPECT_EQ(joint["blocks"].size(), 2);
  EXPECT_EQ(joint["num_control_points"], 6);
  EXPECT_NE(formats::ReadWholeFile(site_ / "out/certificate.html").find("Joint adjustment of the blocks"),
            std::string::npos);
  ReplaceInFile(site_ / "control/points.csv", "5600208.0000,500102.0004", "5600208.0000,500102.0024");  // a check point
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "network", "report"}));
  ReplaceInFile(site_ / "control/points.csv", "5600208.0000,500102.0024", "5600208.0000,500102.0004");
  site_.StagesOfRun();
  ExpectJoinChecksItsInputs(site_);
  ReplaceInFile(site_ / "site.toml", "joint = true", "# joint = false");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A adjust", "A edit", "A grid", "B adjust", "B edit", "B grid", "certify",
                                         "network", "report", "requests", "stitch"}));
  const auto back = site_.Results();
  for (const auto& [file, digest] : apart) EXPECT_EQ(back.at(file), digest) << file;
}

TEST_F(RerunTest, BlockAddedAndRemoved) {
  fs::create_directories(site_ / "blocks/C");
  fs::copy(test_support::FieldDataOfTwoRooms() / "blocks/B", site_ / "blocks/C/raw");
  fs::rename(site_ / "blocks/C/raw/marks.csv", site_ / "blocks/C/marks.csv");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"C adjust", "C edit", "C grid", "C ingest", "C loops", "C track", "certify",
                                         "network", "report", "requests", "stitch"}));
  fs::remove_all(site_ / "blocks/C");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "network", "report", "requests", "stitch"}));
}

TEST_F(RerunTest, MarkRemovedAddedAndMoved) {
  const auto before = site_.Results();
  const Stages expected = {"B adjust", "B edit",  "B grid", "B ingest", "B loops", "B track",
                           "certify",  "network", "report", "requests", "stitch"};
  const fs::path marks = site_ / "blocks/B/marks.csv";
  const std::string text = formats::ReadWholeFile(marks);
  const std::size_t last_row = text.rfind('\n', text.size() - 2) + 1;
  formats::WriteFileAtomically(marks, text.substr(0, last_row));
  EXPECT_EQ(site_.StagesOfRun(), expected);
  formats::WriteFileAtomically(marks, text);
  EXPECT_EQ(site_.StagesOfRun(), expected);
  EXPECT_EQ(Differences(site_.Results(), before), std::vector<std::string>{});
  // The same point, marked a little later.
  ReplaceInFile(marks, "4,2036.777,2037.177", "4,2036.877,2037.277");
  EXPECT_EQ(site_.StagesOfRun(), expected);
  EXPECT_NE(site_.Results().at("work/B/solution.sqlite"), before.at("work/B/solution.sqlite"));
}

// Undone by a line that retires it: the maps are then as they were, and only what the edits reach runs.
TEST_F(RerunTest, EditAddedAndRetired) {
  const auto before = site_.Results();
  formats::WriteFileAtomically(site_ / "drawn.geojson",
                               R"({"type": "FeatureCollection", "features": [{"type": "Feature",
    "properties": {"uid": "cupboard", "kind": "area_free", "why": "moved away"},
    "geometry": {"type": "Polygon", "coordinates": [[[500103, 5600203], [500104, 5600203], [500104, 5600204],
                                                     [500103, 5600203]]]}}]})");
  const auto edits = [&](const Stages& more) {
    Stages command = {"plumbline", "edits"};
    command.insert(command.end(), more.begin(), more.end());
    const test_support::CommandResult result = test_support::RunCommand(command);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  const std::string site = site_.path();
  edits({"add", site, "--from", site + "/drawn.geojson", "--who", "M. Huber"});
  EXPECT_NE(edits({"list", site}).find("cupboard"), std::string::npos);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A edit", "B edit", "certify", "report", "robots", "stitch"}));
  edits({"retire", site, "--uid", "cupboard", "--who", "M. Huber", "--why", "still there"});
  EXPECT_EQ(edits({"list", site}).find("cupboard"), std::string::npos);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A edit", "B edit", "certify", "report", "robots", "stitch"}));
  for (const char* map : {"work/A/map.tif", "work/B/map.tif", "out/site.tif", "out/ros/map.pgm"})
    EXPECT_EQ(site_.Results().at(map), before.at(map)) << map;
}

// A forbidden area is known to the mask of robots alone.
TEST_F(RerunTest, EditsReachWhatTheyConcern) {
  const std::string site = site_.path();
  const auto draw = [&](const std::string& kind, const std::string& corners) {
    formats::WriteFileAtomically(
        site_ / "drawn.geojson",
        R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"kind": ")" + kind +
            R"("}, "geometry": {"type": "Polygon", "coordinates": [[)" + corners + "]]}}]}");
    const test_support::CommandResult result = test_support::RunCommand(
        {"plumbline", "edits", "add", site, "--from", site + "/drawn.geojson", "--who", "M. Huber"});
    EXPECT_EQ(result.status, 0) << result.err;
  };
  const std::string square = "[500103,5600203],[500104,5600203],[500104,5600204],[500103,5600204],[500103,5600203]";
  draw("area_free", square);
  site_.StagesOfRun();
  const auto before = site_.Results();
  draw("forbidden", square);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A edit", "B edit", "certify", "report", "robots"}));
  EXPECT_NE(site_.Results().at("out/ros/keepout.pgm"), before.at("out/ros/keepout.pgm"));
  EXPECT_EQ(site_.Results().at("out/site.tif"), before.at("out/site.tif"));
}

// An answer re-runs its block from the adjustment on and is counted; without it all is as before.
TEST_F(RerunTest, AnswerAddedAndRemoved) {
  const auto before = site_.Results();
  const std::vector<survey::ScanStamp> stamps = formats::ReadScanStamps(site_ / "work/A/track.sqlite");
  formats::WriteFileAtomically(
      site_ / "blocks/A/answers/q1.json",
      R"({"schema": 1, "decision": "skip", "stamp_ns": ")" + std::to_string(stamps[20].clock_ns) + R"("})");
  const Stages expected = {"A adjust", "A edit", "A grid", "A track", "certify", "report", "requests", "stitch"};
  EXPECT_EQ(site_.StagesOfRun(), expected);
  const auto review =
      nlohmann::json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"))["blocks"][0]["review"];
  EXPECT_EQ(review["num_answers"], 1);
  AppendToFile(site_ / "blocks/A/answers/q1.json", "\n");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A adjust", "A track", "requests"}));  // it says the same
  fs::remove(site_ / "blocks/A/answers/q1.json");
  EXPECT_EQ(site_.StagesOfRun(), expected);
  EXPECT_EQ(Differences(site_.Results(), before), std::vector<std::string>{});
}

TEST_F(RerunTest, CheckFeaturesAddedAndRemoved) {
  const auto before = site_.Results();
  const fs::path features = site_ / "control/features.csv";
  fs::copy_file(test_support::FieldDataOfTwoRooms() / "control/features.csv", features);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A features", "B features", "certify", "report"}));
  AppendToFile(features, "# looked over on Friday\n");
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"A features", "B features", "certify"}));
  fs::remove(features);
  EXPECT_EQ(site_.StagesOfRun(), (Stages{"certify", "report"}));
  fs::remove(site_ / "work/A/features.sqlite");
  fs::remove(site_ / "work/B/features.sqlite");
  EXPECT_EQ(Differences(site_.Results(), before), std::vector<std::string>{});
}

// A new build of one program re-runs its stage; results that come out as before stop the chain there.
TEST_F(RerunTest, NewProgramVersion) {
  const test_support::ScratchFolder scratch;
  for (const char* folder : {"bin", "share"}) {
    fs::copy(test_support::BinFolder().parent_path() / folder, scratch / folder, fs::copy_options::recursive);
  }
  const std::string run = scratch / "bin/plumbline";
  EXPECT_EQ(test_support::RunCommand({run, "run", site_.path()}).out, "");
  const fs::path program = scratch / "bin/plumbline-grid";
  AppendToFile(program, "another build");
  const std::string status = test_support::RunCommand({run, "status", site_.path()}).out;
  EXPECT_NE(status.find("A grid    stale: plumbline-grid is another build\n"), std::string::npos) << status;
  EXPECT_EQ(test_support::RunCommand({run, "run", site_.path()}).out, "A grid\nB grid\n");
  EXPECT_EQ(test_support::RunCommand({run, "run", site_.path()}).out, "");
}

TEST_F(RerunTest, DeletedResultsComeBack) {
  const auto before = site_.Results();
  fs::remove(site_ / "out/ros/map.pgm");
  EXPECT_EQ(site_.StagesOfRun(), Stages{"stitch"});
  fs::remove(site_ / "work/A/track.sqlite");
  EXPECT_EQ(site_.StagesOfRun({"work/A/track.sqlite"}), Stages{"A track"});
  fs::remove_all(site_ / "work");
  EXPECT_EQ(site_.StagesOfRun({"-j4"}).size(), 17);
  EXPECT_EQ(Differences(site_.Results(), before), std::vector<std::string>{});
}

TEST_F(RerunTest, TargetsAreStagesBlocksAndFiles) {
  fs::remove_all(site_ / "work");
  EXPECT_EQ(site_.StagesOfRun({"ingest"}), (Stages{"A ingest", "B ingest"}));
  EXPECT_EQ(site_.StagesOfRun({"A"}), (Stages{"A adjust", "A edit", "A grid", "A loops", "A track", "network"}));
  EXPECT_EQ(site_.StagesOfRun({(site_ / "work/B/loops.sqlite").string()}), (Stages{"B loops", "B track"}));
}

TEST_F(RerunTest, FailureStopsAndIsTold) {
  const fs::path points = site_ / "control/points.csv";
  const auto before = site_.Results();
  ReplaceInFile(points, "2,5600202.0014,", "2,north,");
  const test_support::CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(run.out, "network\n");
  EXPECT_NE(run.err.find("points.csv:3"), std::string::npos) << run.err;
  EXPECT_EQ(Differences(site_.Results(), before), std::vector<std::string>{});
  const std::string status = test_support::RunCommand({"plumbline", "status", site_.path()}).out;
  EXPECT_NE(status.find("network   failed: control/points.csv:3"), std::string::npos) << status;
  EXPECT_NE(status.find("A adjust  waiting for network"), std::string::npos) << status;
  ReplaceInFile(points, "2,north,", "2,5600202.0014,");
  EXPECT_EQ(site_.StagesOfRun(), Stages{"network"});
}

}  // namespace
