// SPDX-License-Identifier: Apache-2.0
//
// plumbline-stitch on maps made here.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/raster_facts.h"
#include "formats/raster_file.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::CommandResult;
using test_support::RunCommand;

// A site's work folder with solutions and grids of small blocks.
class StitchTest : public testing::Test {
 protected:
  // A square room of 8 m with its south-west corner at (x, y).
  void MakeBlock(const std::string& name, bool tied, double x, double cell_size_m = 0.05,
                 const std::string& crs = "EPSG:25832", double y = 0) {
    const fs::path folder = scratch_ / name;
    fs::create_directories(folder);
    const formats::Provenance own{
        .records = {{.stage = "adjust", .version = "1", .options = {{"block", name}}, .inputs = {}}}};
    survey::Solution solution;
    solution.tied = tied;
    solution.scans = {{.scan = survey::ScanId{0}, .is_node = true}};
    solution.covariances = {{survey::ScanId{0}, Eigen::Vector3d(1e-4, 1e-4, 1e-8).asDiagonal()}};
    formats::WriteSolution(folder / "solution.sqlite", solution, {{}}, own);
    formats::Provenance chain{
        .records = {{.stage = "grid",
                     .version = "1",
                     .options = {},
                     .inputs = {{.role = "solution", .sha256 = "0", .record_id = own.Own().Id()}}},
                    own.Own()}};
    survey::SiteRaster room{.cell_size_m = cell_size_m,
                            .min_column = std::llround(x / cell_size_m),
                            .min_row = std::llround(y / cell_size_m),
                            .width = static_cast<int>(std::lround(8 / cell_size_m)),
                            .height = static_cast<int>(std::lround(8 / cell_size_m))};
    room.log_odds.assign(static_cast<std::size_t>(room.width * room.height), -2.0F);
    for (int i = 0; i < room.width; ++i) {
      room.At(i, 10) = room.At(i, room.height - 11) = room.At(10, i) = room.At(room.width - 11, i) = 3.0F;
    }
    formats::RasterLabel label;
    label.tied = tied;
    if (tied) label.frame.crs = crs;
    formats::WriteRaster(folder / "grid.tif", room, label, chain);
  }

  CommandResult Edit(const std::string& name) {
    return RunCommand({"plumbline-edit", "--grid", Path(name, "grid.tif"), "--solution", Path(name, "solution.sqlite"),
                       "--output", Path(name, "map.tif"), "--report", Path(name, "edits.json"), "--doubtful",
                       Path(name, "doubtful_edits.json")});
  }

  CommandResult Stitch(const std::vector<std::string>& names, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = {"plumbline-stitch", "--map"};
    for (const std::string& name : names) command.push_back(name + "=" + Path(name, "map.tif"));
    command.push_back("--solution");
    for (const std::string& name : names) command.push_back(name + "=" + Path(name, "solution.sqlite"));
    command.insert(command.end(), {"--output", out_.string()});
    command.insert(command.end(), more.begin(), more.end());
    return RunCommand(command);
  }

  std::string Path(const std::string& name, const std::string& file) const { return (scratch_ / name / file).string(); }
  json Seams() const { return json::parse(formats::ReadWholeFile(out_ / "seams.json")); }

  test_support::ScratchFolder scratch_;
  fs::path out_ = scratch_ / "out";
};

TEST_F(StitchTest, TiedBlocksMakeTheSite) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 4);
  ASSERT_EQ(Edit("B1").status, 0);
  ASSERT_EQ(Edit("B2").status, 0);
  const CommandResult result = Stitch({"B1", "B2"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* file : {"site.tif", "site.png", "site.pgw", "site.png.aux.xml", "ros/map.yaml", "ros/map.pgm"}) {
    EXPECT_TRUE(fs::exists(out_ / file)) << file;
  }
  EXPECT_FALSE(fs::exists(out_ / "local"));
  const json seams = Seams();
  EXPECT_EQ(seams["site_map"], "site.tif");
  EXPECT_EQ(seams["tied"], true);
  EXPECT_EQ(seams["crs"], "EPSG:25832");
  ASSERT_EQ(seams["seams"].size(), 1U);
  EXPECT_EQ(seams["seams"][0]["blocks"], (json{"B1", "B2"}));
  EXPECT_NEAR(seams["seams"][0]["overlap_area_m2"].get<double>(), 4 * 8, 1e-6);
  EXPECT_EQ(formats::ReadProvenance(out_ / "site.tif").Own().Id(),
            formats::ReadProvenance(out_ / "seams.json").Own().Id());
}

TEST_F(StitchTest, TheLogOddsAreArchivedOnRequest) {
  MakeBlock("B1", true, 0);
  ASSERT_EQ(Edit("B1").status, 0);
  ASSERT_EQ(Stitch({"B1"}, {"--float-archive", "true"}).status, 0);
  formats::RasterLabel label;
  const survey::SiteRaster archive = formats::ReadRaster(out_ / "site-log-odds.tif", &label);
  EXPECT_EQ(archive.log_odds, formats::ReadRaster(Path("B1", "map.tif")).log_odds);
  EXPECT_EQ(label.frame.crs, "EPSG:25832");
  const std::string info = RunCommand({"gdalinfo", (out_ / "site-log-odds.tif").string()}).out;
  EXPECT_NE(info.find("Type=Float32"), std::string::npos) << info;
  ASSERT_EQ(Stitch({"B1"}).status, 0);
  EXPECT_FALSE(fs::exists(out_ / "site-log-odds.tif"));
}

TEST_F(StitchTest, BlocksThatContradictEachOtherAreNamed) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 0.15);  // the same room three cells further east
  MakeBlock("B3", true, 0);
  for (const char* block : {"B1", "B2", "B3"}) ASSERT_EQ(Edit(block).status, 0);
  const CommandResult result = Stitch({"B1", "B2", "B3"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("warning: blocks B1 and B2 contradict each other"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("warning: blocks B2 and B3 contradict each other"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("B1 and B3"), std::string::npos) << result.err;
  EXPECT_EQ(Seams()["seams"][0]["contradicts"], true);
  EXPECT_NEAR(Seams()["seams"][0]["offset_m"][0].get<double>(), 0.15, 0.01);
  EXPECT_EQ(Seams()["seams"][1]["contradicts"], false);
  const json layer = json::parse(formats::ReadWholeFile(out_ / "seams.geojson"));
  EXPECT_EQ(layer["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::25832");
  ASSERT_FALSE(layer["features"].empty());
  const json line = layer["features"][0]["geometry"]["coordinates"];
  EXPECT_NEAR(line[1][0].get<double>() - line[0][0].get<double>(),
              100 * layer["features"][0]["properties"]["east_m"].get<double>(), 1e-6);
}

// A campus of 12 blocks in a grid, each 4 m into its neighbours: seams are those of neighbours alone.
TEST_F(StitchTest, ManyBlocks) {
  std::vector<std::string> blocks;
  for (int i = 0; i < 12; ++i) {
    blocks.push_back("K" + std::to_string(100 + i));
    MakeBlock(blocks.back(), true, 4.0 * (i % 4), 0.05, "EPSG:25832", 4.0 * (i / 4));
    ASSERT_EQ(Edit(blocks.back()).status, 0);
  }
  const CommandResult result = Stitch(blocks);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(Seams()["seams"].size(), 3U * 3 + 2 * 4 + 2 * 3 * 2);  // east, north, diagonal
  EXPECT_EQ(formats::ReadRasterFacts(out_ / "site.tif").width, 20 * 20);
}

// Two blocks far apart: the site between them costs no memory. PLUMBLINE_SITE_CELLS=50000 tries what a large campus
// needs.
TEST_F(StitchTest, MemoryDoesNotGrowWithTheArea) {
  const char* wanted = std::getenv("PLUMBLINE_SITE_CELLS");
  const int cells = wanted != nullptr ? std::atoi(wanted) : 6000;
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 0.05 * cells - 8, 0.05, "EPSG:25832", 0.05 * cells - 8);
  for (const char* block : {"B1", "B2"}) ASSERT_EQ(Edit(block).status, 0);
  const CommandResult result = Stitch({"B1", "B2"});
  ASSERT_EQ(result.status, 0) << result.err;
  const formats::RasterFacts facts = formats::ReadRasterFacts(out_ / "site.tif");
  EXPECT_EQ(facts.width, cells);
  EXPECT_EQ(facts.height, cells);
  EXPECT_EQ(facts.num_known, 2 * 160 * 160);
  EXPECT_GE(facts.num_overviews, 3);
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const double megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  RecordProperty("stitch_peak_mb", static_cast<int>(megabytes));
  // Fixed costs, GDAL's cache of 128 MB, and a few strips; the cells as floats would take 144 MB, or 10 GB.
  EXPECT_LT(megabytes, 200 + cells * 512 * 9e-6);
}

TEST_F(StitchTest, TheSameInputsGiveTheSameBytes) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 4);
  Edit("B1");
  Edit("B2");
  ASSERT_EQ(Stitch({"B1", "B2"}).status, 0);
  const std::string seams = formats::ReadWholeFile(out_ / "seams.json");
  const std::string site = formats::ReadWholeFile(out_ / "site.tif");
  fs::remove_all(out_);
  ASSERT_EQ(Stitch({"B1", "B2"}).status, 0);
  EXPECT_TRUE(formats::ReadWholeFile(out_ / "seams.json") == seams);
  EXPECT_TRUE(formats::ReadWholeFile(out_ / "site.tif") == site);
}

TEST_F(StitchTest, AnUntiedBlockIsDeliveredApart) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", false, 4);
  Edit("B1");
  Edit("B2");
  const CommandResult result = Stitch({"B1", "B2"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("B2 is not tied to control"), std::string::npos);
  EXPECT_TRUE(fs::exists(out_ / "site.tif"));
  EXPECT_TRUE(fs::exists(out_ / "local/B2.tif"));
  EXPECT_TRUE(fs::exists(out_ / "local/B2.png"));
  EXPECT_TRUE(Seams()["seams"].empty());
  EXPECT_EQ(Seams()["blocks"][1]["map"], "local/B2.tif");
  // Once it is tied, the map in the local frame goes.
  MakeBlock("B2", true, 4);
  Edit("B2");
  ASSERT_EQ(Stitch({"B1", "B2"}).status, 0);
  EXPECT_FALSE(fs::exists(out_ / "local/B2.tif"));
  EXPECT_FALSE(fs::exists(out_ / "local/B2.pgw"));
}

TEST_F(StitchTest, WithoutAnyTiedBlockNoOldSiteMapStaysBehind) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 4);
  Edit("B1");
  Edit("B2");
  ASSERT_EQ(Stitch({"B1", "B2"}).status, 0);
  MakeBlock("B1", false, 0);
  MakeBlock("B2", false, 4);
  Edit("B1");
  Edit("B2");
  const CommandResult result = Stitch({"B1", "B2"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("no block is tied to control"), std::string::npos);
  for (const char* file : {"site.tif", "site.png", "site.pgw", "site.png.aux.xml", "ros"}) {
    EXPECT_FALSE(fs::exists(out_ / file)) << file;
  }
  EXPECT_TRUE(fs::exists(out_ / "local/B1.tif"));
  EXPECT_TRUE(Seams()["site_map"].is_null());
  EXPECT_EQ(Seams()["tied"], false);
}

TEST_F(StitchTest, OneUntiedBlockIsTheSiteInItsLocalFrame) {
  MakeBlock("B1", false, 0);
  Edit("B1");
  const CommandResult result = Stitch({"B1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("not tied to control"), std::string::npos);
  EXPECT_EQ(Seams()["site_map"], "site.tif");
  EXPECT_EQ(Seams()["tied"], false);
  EXPECT_NE(formats::ReadWholeFile(out_ / "site.png.aux.xml").find("not tied to control"), std::string::npos);
}

TEST_F(StitchTest, MapsThatDoNotFitAreBothNamed) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 4, 0.1);
  Edit("B1");
  Edit("B2");
  const CommandResult cells = Stitch({"B1", "B2"});
  EXPECT_EQ(cells.status, 1);
  MakeBlock("B2", true, 4, 0.05, "EPSG:25833");
  Edit("B2");
  const CommandResult crs = Stitch({"B1", "B2"});
  EXPECT_EQ(crs.status, 1);
  EXPECT_NE(crs.err.find("EPSG:25833"), std::string::npos);
  for (const CommandResult& result : {cells, crs}) {
    EXPECT_NE(result.err.find("B1/map.tif"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("B2/map.tif"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(StitchTest, AMapOfAnotherSolutionIsRefused) {
  MakeBlock("B1", true, 0);
  MakeBlock("B2", true, 4);
  Edit("B1");
  Edit("B2");
  fs::copy_file(Path("B1", "map.tif"), Path("B2", "map.tif"), fs::copy_options::overwrite_existing);
  const CommandResult result = Stitch({"B1", "B2"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("was not made from"), std::string::npos) << result.err;
}

}  // namespace
