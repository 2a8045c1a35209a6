// SPDX-License-Identifier: Apache-2.0
//
// Map edits in a whole site, by the real executables: drawn, applied, following control, masked, undone, refused.
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/edit_json.h"
#include "formats/edit_ledger.h"
#include "formats/raster_file.h"
#include "tests/support/job_site.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::CommandResult;
using test_support::JobSite;
using test_support::ReplaceInFile;

// As QGIS does when a person deletes the features of a layer.
void DeleteAreas(const fs::path& package) {
  GDALAllRegister();
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(package.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE, nullptr, nullptr, nullptr));
  ASSERT_NE(data, nullptr);
  data->ReleaseResultSet(data->ExecuteSQL("DELETE FROM edit_areas", nullptr, nullptr));
}

class EditsTest : public testing::Test {
 protected:
  CommandResult Edits(const std::string& action, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = {"plumbline", "edits", action, site_.path().string()};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command);
  }
  CommandResult Draw(const json& properties, const json& coordinates, const std::string& type = "Polygon") {
    const json feature = {
        {"type", "Feature"}, {"properties", properties}, {"geometry", {{"type", type}, {"coordinates", coordinates}}}};
    formats::WriteFileAtomically(site_ / "drawn.geojson",
                                 json{{"type", "FeatureCollection"}, {"features", json::array({feature})}}.dump());
    return Edits("add", {"--from", site_ / "drawn.geojson", "--who", "M. Huber"});
  }
  // Corners of a rectangle in the plan of the rooms.
  static json Rectangle(double x, double y, double width, double height) {
    const double e = 500100.0 + x;
    const double n = 5600200.0 + y;
    const json ring = {{e, n}, {e + width, n}, {e + width, n + height}, {e, n + height}, {e, n}};
    return json::array({ring});
  }
  json Report(const std::string& block) const {
    return json::parse(formats::ReadWholeFile(site_ / ("work/" + block + "/edits.json")));
  }

  JobSite site_ = JobSite::Processed();
};

// The wall in the east of room A is drawn on the map; a point of its control moves by 2 cm.
TEST_F(EditsTest, AnEditFollowsItsWallWhenControlChanges) {
  const json wall = {{500103.0, 5600209.85}, {500106.0, 5600209.85}};
  ASSERT_EQ(Draw({{"uid", "wall"}, {"kind", "line_occupied"}, {"width_m", 0.1}}, wall, "LineString").status, 0);
  ASSERT_EQ(Draw({{"uid", "plan"}, {"kind", "line_occupied"}, {"frame", "site"}}, wall, "LineString").status, 0);
  const formats::Ledger ledger = formats::ReadLedger(site_ / "edits/ledger.jsonl");
  EXPECT_EQ(ledger.Active()[0].parts.front().size(), 3U) << "a vertex every 2 m at least";
  EXPECT_TRUE(ledger.Active()[0].anchors.contains("A"));
  EXPECT_EQ(site_.Run().status, 0);
  ReplaceInFile(site_ / "control/points.csv", "1,5600201.9973,", "1,5600201.9773,");
  EXPECT_EQ(site_.Run().status, 0);
  for (const json& applied : Report("A")["edits"]) {
    const double moved = applied["shift_m"];
    const bool stays = applied["edit"]["uid"] == "plan";
    EXPECT_GE(moved, stays ? 0.0 : 0.002);
    EXPECT_LE(moved, stays ? 0.0 : 0.03);
  }
  const json certificate = json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"));
  EXPECT_EQ(certificate["edits"]["num_edits"], 2);
  EXPECT_EQ(certificate["edits"]["findings"], json::array());
  ASSERT_EQ(Edits("retire", {"--uid", "wall", "--who", "AB", "--why", "torn down"}).status, 0);
  EXPECT_EQ(site_.Run().status, 0);
  const std::string lines =
      test_support::RunCommand({"ogrinfo", "-al", "-where", "uid='wall'", site_ / "out/site.gpkg", "edit_lines"}).out;
  EXPECT_NE(lines.find("state (String) = retired"), std::string::npos) << lines;
  EXPECT_NE(lines.find(": torn down"), std::string::npos) << lines;
}

// With no bend allowed, the wall is asked about as soon as its control moves; a person says that it lies well.
TEST_F(EditsTest, AnEditThatCouldNotFollowIsAskedAboutUntilSomebodySettlesIt) {
  const auto requests = [&] {
    std::vector<json> of_edits;
    std::istringstream lines(formats::ReadWholeFile(site_ / "work/requests.jsonl"));
    for (std::string line; std::getline(lines, line);) {
      if (json::parse(line).value("kind", "") == "edit") of_edits.push_back(json::parse(line));
    }
    return of_edits;
  };
  // Round the room: what different scans drew does not move as one.
  const json wall = {{500107.5, 5600200.15}, {500100.15, 5600200.15}, {500100.15, 5600209.85}, {500107.5, 5600209.85}};
  ASSERT_EQ(Draw({{"uid", "wall"}, {"kind", "line_occupied"}, {"width_m", 0.1}}, wall, "LineString").status, 0);
  const auto stages = site_.StagesOfRun();
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "A edit"), 1);
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "requests"), 0) << "an edit without doubt changes nothing there";
  ReplaceInFile(site_ / "site.toml", "# refit-residual-m = 0.15", "refit-residual-m = 0.0001");
  ReplaceInFile(site_ / "control/points.csv", "1,5600201.9973,", "1,5600201.9773,");
  EXPECT_EQ(site_.Run().status, 0);
  ASSERT_EQ(requests().size(), 1U);
  const json request = requests()[0];
  EXPECT_EQ(request["edit"]["uid"], "wall");
  EXPECT_EQ(request["causes"][0]["cause"], "edit_review");
  EXPECT_EQ(request["drawn"]["coordinates"][0][1], 5600200.15);
  EXPECT_NE(request["edit"]["geometry"], request["drawn"]);
  EXPECT_TRUE(fs::exists(site_ / "work" / request["picture"].get<std::string>()));
  const std::string status = test_support::RunCommand({"plumbline", "status", site_.path().string()}).out;
  EXPECT_NE(status.find("review requests have no answer"), std::string::npos) << status;

  ASSERT_EQ(Edits("keep", {"--uid", "wall", "--who", "CD", "--why", "looked at it"}).status, 0);
  const survey::MapEdit kept = formats::ReadLedger(site_ / "edits/ledger.jsonl").Active().at(0);
  EXPECT_EQ(kept.revision, 2);
  EXPECT_EQ(kept.who, "CD");
  EXPECT_EQ(formats::GeometryToJson(kept), request["edit"]["geometry"]) << "where it lies now";
  const auto settling = site_.StagesOfRun();
  EXPECT_EQ(std::count(settling.begin(), settling.end(), "requests"), 1);
  EXPECT_EQ(std::count(settling.begin(), settling.end(), "A adjust"), 0);
  EXPECT_TRUE(requests().empty()) << "it is tied anew where it lay";
}

TEST_F(EditsTest, AMaskReachesBackToTheFieldDataAndIsUndone) {
  const auto before = site_.Results();
  // The pillar in room A, as if it were a passer-by.
  ASSERT_EQ(Draw({{"uid", "pillar"}, {"kind", "mask_returns"}}, Rectangle(3.5, 4.5, 1.0, 1.0)).status, 0);
  const auto stages = site_.StagesOfRun();
  for (const char* stage : {"A feedback", "A ingest", "A track", "A grid", "A edit", "certify"})
    EXPECT_NE(std::find(stages.begin(), stages.end(), stage), stages.end()) << stage;
  const survey::SiteRaster map = formats::ReadRaster(site_ / "work/A/map.tif");
  int walls = 0;
  for (const double x : {3.8, 4.2}) {
    for (double y = 4.8; y < 5.25; y += 0.05) {
      const auto cell = map.CellOf({500100.0 + x, 5600200.0 + y});
      walls += map.At(static_cast<int>(cell.x()), static_cast<int>(cell.y())) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_EQ(walls, 0) << "the pillar is gone";
  // The session holds these returns no more: a new revision keeps the beams.
  const auto beams = formats::ReadLedger(site_ / "edits/ledger.jsonl").Active().at(0).beams;
  ASSERT_EQ(Edits("keep", {"--uid", "pillar", "--who", "AB"}).status, 0);
  EXPECT_EQ(formats::ReadLedger(site_ / "edits/ledger.jsonl").Active().at(0).beams, beams);
  ASSERT_EQ(Edits("retire", {"--uid", "pillar", "--who", "AB"}).status, 0);
  EXPECT_EQ(site_.Run().status, 0);
  for (const char* file : {"work/A/session.sqlite", "work/A/solution.sqlite", "work/A/map.tif", "out/site.tif"})
    EXPECT_EQ(site_.Results().at(file), before.at(file)) << file;
}

// Of the passes by the pillar only the one of the first seconds.
TEST_F(EditsTest, AMaskOfATimeLeavesOtherScansAlone) {
  const json place = Rectangle(3.5, 4.5, 1.0, 1.0);
  ASSERT_EQ(Draw({{"uid", "always"}, {"kind", "mask_returns"}}, place).status, 0);
  ASSERT_EQ(Draw({{"uid", "once"}, {"kind", "mask_returns"}, {"until_ns", "1970-01-01T00:16:44Z"}}, place).status, 0);
  const std::vector<survey::MapEdit> masks = formats::ReadLedger(site_ / "edits/ledger.jsonl").Active();
  const std::vector<survey::MaskedBeams>& once = masks.at(1).beams.at("A");
  EXPECT_LT(once.size(), masks[0].beams.at("A").size());
  for (const survey::MaskedBeams& beams : once) EXPECT_LE(beams.stamp_ns, 1004000000000);
  const CommandResult never = Draw({{"kind", "mask_returns"}, {"until_ns", "5"}}, place);
  EXPECT_NE(never.err.find("no scan has a return from there in that time"), std::string::npos) << never.err;
}

// An arrow of 2 cm beside control of 2 mm: observed and told, but control holds. One of 2 m is left out.
TEST_F(EditsTest, ArrowsAreObservationsThatNeverOutweighControl) {
  const auto arrow = [](double north) {
    return json::array({json::array({{500104.0, 5600209.92}, {500104.0, 5600209.92 + north}})});
  };
  ASSERT_EQ(Draw({{"uid", "near"}, {"kind", "adjust"}}, arrow(0.02), "MultiLineString").status, 0);
  EXPECT_EQ(site_.Run().status, 0);
  const std::string log = formats::ReadWholeFile(site_ / "logs/A-adjust.log");
  EXPECT_NE(log.find("arrow near: the map lies 0.0"), std::string::npos) << log;
  ReplaceInFile(site_ / "site.toml", "# joint = false", "joint = true");
  EXPECT_EQ(site_.Run().status, 0);
  const auto marks = formats::ReadSolution(site_ / "work/A/solution.sqlite").marks;
  EXPECT_FALSE(marks.empty());
  for (const survey::SolvedMark& mark : marks) {
    EXPECT_EQ(mark.point.find("arrow"), std::string::npos);
    if (mark.used) {
      EXPECT_LT(mark.residual.norm(), 0.01) << mark.point;
    }
  }
  ASSERT_EQ(Draw({{"uid", "far"}, {"kind", "adjust"}}, arrow(2.0), "MultiLineString").status, 0);
  EXPECT_EQ(site_.Run().status, 0);
  EXPECT_NE(formats::ReadWholeFile(site_ / "logs/A-adjust.log").find("mark on arrow far was left out"),
            std::string::npos);
  const json certificate = json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"));
  EXPECT_EQ(certificate["fit"].dump().find("arrow"), std::string::npos) << "they are no control";
  const CommandResult sure =
      Draw({{"uid", "sure"}, {"kind", "adjust"}, {"sigma_m", 0.001}}, arrow(0.02), "MultiLineString");
  EXPECT_NE(sure.err.find("a person does not outweigh control"), std::string::npos) << sure.err;
}

TEST_F(EditsTest, PeopleWhoContradictStopTheRunUntilOneGivesWay) {
  const json place = Rectangle(3.0, 3.0, 1.0, 1.0);
  ASSERT_EQ(Draw({{"uid", "cupboard"}, {"kind", "area_occupied"}, {"who", "AB"}}, place).status, 0);
  ASSERT_EQ(Draw({{"uid", "empty"}, {"kind", "area_free"}, {"who", "CD"}}, place).status, 0);
  const auto before = site_.Results();
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1);
  for (const char* part : {"people contradict each other", "area_free empty (CD", "area_occupied cupboard (AB"})
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  EXPECT_EQ(site_.Results().at("work/A/map.tif"), before.at("work/A/map.tif"));
  ReplaceInFile(site_ / "site.toml", "# allow-conflicts = false", "allow-conflicts = true");
  EXPECT_EQ(site_.Run().status, 0);
  const json certificate = json::parse(formats::ReadWholeFile(site_ / "out/certificate.json"));
  EXPECT_NE(certificate["edits"]["findings"].dump().find("contradict each other"), std::string::npos);
}

TEST_F(EditsTest, DrawnInQgisAndAccepted) {
  ASSERT_EQ(Draw({{"uid", "shelf"}, {"kind", "area_free"}}, Rectangle(3.0, 3.0, 1.0, 1.0)).status, 0);
  const std::string package = site_ / "office.gpkg";
  ASSERT_EQ(Edits("checkout", {"--geopackage", package}).status, 0);
  const std::string ledger = formats::ReadWholeFile(site_ / "edits/ledger.jsonl");
  EXPECT_NE(Edits("accept", {"--from", package, "--who", "CD"}).err.find("nothing was changed"), std::string::npos);
  EXPECT_EQ(formats::ReadWholeFile(site_ / "edits/ledger.jsonl"), ledger);
  DeleteAreas(package);
  ASSERT_EQ(Edits("accept", {"--from", package, "--who", "CD"}).status, 0);
  EXPECT_TRUE(formats::ReadLedger(site_ / "edits/ledger.jsonl").Active().empty());
  EXPECT_EQ(Edits("accept", {"--from", package, "--who", "CD"}).status, 1) << "the edit is gone already";
}

// The door between the rooms is forbidden: mask and shapes say so, and the way through it is gone ([AS] figure 12).
TEST_F(EditsTest, RobotsKeepOutOfAForbiddenDoor) {
  ASSERT_EQ(Draw({{"uid", "door"}, {"kind", "forbidden"}, {"class", "virtual"}}, Rectangle(7.8, 3.4, 0.4, 3.2)).status,
            0);
  ASSERT_EQ(site_.Run().status, 0);
  formats::RasterLabel label;
  const survey::SiteRaster frame = formats::ReadRasterFrame(site_ / "out/site.tif", &label);
  const std::string mask = formats::ReadWholeFile(site_ / "out/ros/keepout.pgm");
  const auto pixel = [&](double x, double y) {  // rows of a PGM count from the north
    const auto cell = frame.CellOf({500100.0 + x, 5600200.0 + y});
    const std::int64_t behind = (frame.height - 1 - cell.y()) * frame.width + cell.x();
    const std::size_t header =
        mask.size() - static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    return static_cast<unsigned char>(mask.at(header + static_cast<std::size_t>(behind)));
  };
  EXPECT_EQ(pixel(8.0, 5.0), 0);
  EXPECT_EQ(pixel(7.0, 5.0), 254);
  EXPECT_EQ(pixel(8.0, 8.0), 254) << "a wall is no forbidden area";
  const std::string shapes = formats::ReadWholeFile(site_ / "out/ros/vector_objects.yaml");
  char corner[64];
  const Eigen::Vector2d low = survey::LowCornerOf(frame);
  std::snprintf(corner, sizeof corner, "points: [%.3f, %.3f, ", 500107.8 - low.x(), 5600203.4 - low.y());
  for (const char* part : {"# edit door", "closed: true", "value: 100", static_cast<const char*>(corner)})
    EXPECT_NE(shapes.find(part), std::string::npos) << part << " in\n" << shapes;

  formats::WriteFileAtomically(
      site_ / "goals.csv", "name,easting,northing\nhome,500103,5600203\nnear,500105,5600208\nnext,500113,5600203\n");
  const CommandResult check = test_support::RunCommand(
      {"plumbline-navcheck", "--grid", "A=" + (site_ / "work/A/grid.tif").string(),
       "B=" + (site_ / "work/B/grid.tif").string(), "--map", "A=" + (site_ / "work/A/map.tif").string(),
       "B=" + (site_ / "work/B/map.tif").string(), "--edits", "A=" + (site_ / "work/A/edits.json").string(),
       "B=" + (site_ / "work/B/edits.json").string(), "--goals", site_ / "goals.csv", "--output", site_ / "nav.json"});
  ASSERT_EQ(check.status, 0) << check.err;
  const json goals = json::parse(formats::ReadWholeFile(site_ / "nav.json"))["goals"];
  EXPECT_EQ(goals[0]["after"]["reachable"], true);
  EXPECT_EQ(goals[1]["before"]["reachable"], true);
  EXPECT_EQ(goals[1]["after"]["reachable"], false);
}

// An AR client that speaks rosbridge gets the map, occupies a square and sets the pose of a scan.
TEST_F(EditsTest, AnArClientSendsItsMapBack) {
  const std::string exported = site_ / "map.rosbridge.jsonl";
  const CommandResult out =
      test_support::RunCommand({"plumbline-rosbridge", "--map", "A=" + (site_ / "work/A/map.tif").string(),
                                "B=" + (site_ / "work/B/map.tif").string(), "--output", exported});
  ASSERT_EQ(out.status, 0) << out.err;
  std::istringstream lines(formats::ReadWholeFile(exported));
  json map;
  for (std::string line; std::getline(lines, line);) {
    if (json::parse(line)["op"] == "publish") map = json::parse(line);
  }
  const json& info = map["msg"]["info"];
  const auto index = [&](double x, double y) {
    const double cell = info["resolution"];
    const auto column = static_cast<int>((500100.0 + x - info["origin"]["position"]["x"].get<double>()) / cell);
    const auto row = static_cast<int>((5600200.0 + y - info["origin"]["position"]["y"].get<double>()) / cell);
    return static_cast<std::size_t>(row * info["width"].get<int>() + column);
  };
  for (const double x : {3.025, 3.075}) {
    for (const double y : {3.025, 3.075}) map["msg"]["data"][index(x, y)] = 100;
  }
  const auto stamps = formats::ReadScanStamps(site_ / "work/A/track.sqlite");
  json pose = {{"op", "publish"}, {"topic", "/initialpose"}};
  pose["msg"]["header"]["stamp"] = {{"sec", stamps[40].clock_ns / 1000000000},
                                    {"nanosec", stamps[40].clock_ns % 1000000000}};
  pose["msg"]["pose"]["pose"]["position"] = {{"x", 500106.0}, {"y", 5600203.0}, {"z", 0}};
  pose["msg"]["pose"]["pose"]["orientation"] = {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}};
  pose["msg"]["pose"]["covariance"] = std::vector<double>(36, 0.01);
  formats::WriteFileAtomically(site_ / "back.jsonl", map.dump() + "\n" + pose.dump() + "\n");
  const CommandResult added = Edits("add", {"--from", site_ / "back.jsonl", "--who", "AB"});
  ASSERT_EQ(added.status, 0) << added.err;
  const std::vector<survey::MapEdit> edits = formats::ReadLedger(site_ / "edits/ledger.jsonl").Active();
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0].kind, survey::EditKind::kCells);
  EXPECT_EQ(edits[0].cells_state, survey::CellState::kOccupied);
  const std::string stamp = std::to_string(stamps[40].clock_ns);
  const json answer = json::parse(formats::ReadWholeFile(site_ / ("blocks/A/answers/rosbridge-" + stamp + ".json")));
  EXPECT_EQ(answer["frame"], "site");
  ASSERT_EQ(site_.Run({"A"}).status, 0);
  EXPECT_EQ(Report("A")["edits"][0]["changed_cells"], 4);
}

TEST_F(EditsTest, WhatCannotBeIsRefusedAndNothingIsWritten) {
  const auto refused = [&](const CommandResult& result, const std::string& told) {
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_NE(result.err.find(told), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(site_ / "edits/ledger.jsonl"));
  };
  refused(
      Draw({{"kind", "area_free"}}, Rectangle(300, 0, 1, 1)),
      "drawn.geojson: feature 1: area_free: vertex 1 at E 500400.000 N 5600200.000 lies 283 m outside the map: the map "
      "of block A reaches from E 500100.10");
  json slipped = Rectangle(3, 3, 1, 1);
  slipped[0][2] = {500104.0, 5600302.0};
  refused(Draw({{"kind", "forbidden"}}, slipped),
          "feature 1: forbidden: vertex 3 at E 500104.000 N 5600302.000 lies 9");
  for (const char* kind : {"forbidden", "area_free"})
    refused(Draw({{"kind", kind}}, Rectangle(25, 0, 1, 1)), "lies outside the map and covers none of its cells");
  refused(Draw({{"kind", "adjust"}}, {{{500120.0, 5600203.0}, {500112.0, 5600203.0}}}, "MultiLineString"),
          "no scan drew the map at the tail of arrow 1, E 500120.000");
  refused(Draw({{"kind", "area_gone"}}, Rectangle(3, 3, 1, 1)), "drawn.geojson: feature 1: kind = \"area_gone\"");
  json crossed = Rectangle(3, 3, 1, 1);
  std::swap(crossed[0][1], crossed[0][2]);
  refused(Draw({{"kind", "forbidden"}}, crossed), "feature 1: the polygon crosses or touches itself");
  refused(Draw({{"kind", "mask_returns"}}, Rectangle(1.5, 7.0, 0.02, 0.02)), "no scan has a return from there");
  refused(Draw({{"kind", "area_free"}, {"when", "today"}}, Rectangle(3, 3, 1, 1)), "when = \"today\"");
}

TEST_F(EditsTest, ABrokenLedgerStopsTheRunAndOldMapsStay) {
  ASSERT_EQ(Draw({{"uid", "shelf"}, {"kind", "area_free"}}, Rectangle(3.0, 3.0, 1.0, 1.0)).status, 0);
  ASSERT_EQ(Draw({{"uid", "table"}, {"kind", "area_free"}}, Rectangle(5.0, 3.0, 1.0, 1.0)).status, 0);
  EXPECT_EQ(site_.Run().status, 0);
  const auto before = site_.Results();
  ReplaceInFile(site_ / "edits/ledger.jsonl", "\"uid\":\"shelf\"", "\"uid\":\"shelv\"");
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("edits/ledger.jsonl:2: prev = "), std::string::npos) << run.err;
  EXPECT_EQ(test_support::Differences(site_.Results(), before), std::vector<std::string>{});
}

}  // namespace
