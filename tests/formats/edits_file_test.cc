// SPDX-License-Identifier: Apache-2.0
#include "formats/edits_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/edit_json.h"
#include "formats/errors.h"
#include "formats/stamp_text.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::ScratchFolder;

std::string Collection(const std::string& features, const std::string& more = "") {
  return R"({"type": "FeatureCollection", )" + more + R"("features": [)" + features + "]}";
}

std::string Feature(const std::string& properties, const std::string& geometry) {
  return R"({"type": "Feature", "properties": )" + properties + R"(, "geometry": )" + geometry + "}";
}

const char* const kLine = R"({"type": "LineString", "coordinates": [[500000.1, 5600000.2], [500003, 5600004, 9]]})";
const char* const kSquare = R"({"type": "Polygon", "coordinates": [[[0,0],[4,0],[4,4],[0,4],[0,0]]]})";

std::vector<survey::MapEdit> Read(const std::string& text) {
  const ScratchFolder scratch;
  WriteFileAtomically(scratch / "cars.geojson", text);
  return ReadEdits(scratch / "cars.geojson", "EPSG:25832");
}

TEST(ReadEdits, ReadsWhatQgisAndPeopleWrite) {
  const auto edits = Read(Collection(
      Feature(R"({"kind": "line_occupied", "width_m": 0.2, "who": "AB", "why": "glass front", "class": "glass"})",
              kLine) +
          "," + Feature(R"({"kind": "area_unknown", "width_m": null, "who": null, "frame": "site"})", kSquare),
      R"("name": "cars", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}, )"));
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[0].kind, survey::EditKind::kLineOccupied);
  EXPECT_EQ(edits[0].obstacle, survey::ObstacleClass::kGlass);
  EXPECT_EQ(edits[0].frame, survey::EditFrame::kMap);
  EXPECT_EQ(edits[0].width_m, 0.2);
  EXPECT_EQ(edits[0].who, "AB");
  EXPECT_EQ(edits[0].why, "glass front");
  ASSERT_EQ(edits[0].parts.front().size(), 2U);
  EXPECT_EQ(edits[0].parts.front()[1], Eigen::Vector2d(500003, 5600004));
  EXPECT_EQ(edits[1].frame, survey::EditFrame::kSite);
  EXPECT_EQ(edits[1].parts.front().size(), 4U);
  EXPECT_FALSE(edits[1].width_m);
}

TEST(ReadEdits, MasksMayHoldForATime) {
  const auto edits = Read(Collection(
      Feature(R"({"kind": "mask_returns", "from_ns": "1970-01-02T00:00:01.5Z", "until_ns": 99999999999999})", kSquare) +
      "," + Feature(R"({"kind": "mask_returns", "from_ns": "", "until_ns": "1048200000000000001"})", kSquare)));
  EXPECT_EQ(edits.at(0).from_ns, 86401500000000);
  EXPECT_EQ(edits[0].until_ns, 99999999999999);
  EXPECT_FALSE(edits.at(1).from_ns);
  EXPECT_EQ(edits[1].until_ns, 1048200000000000001) << "a double would end in ...000";
  EXPECT_EQ(EditFromJson(ToJson(edits[1]), "").until_ns, edits[1].until_ns);
  EXPECT_EQ(StampFromText("2026-11-28T10:15:00Z"), 1795860900000000000);
}

TEST(ReadEdits, EveryMistakeIsNamedWithFileAndFeature) {
  const std::string line = R"({"kind": "line_free"})";
  const std::string area = R"({"kind": "area_free"})";
  const std::string good = Feature(line, kLine);
  const std::string crs84 = R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}, )";
  const auto ring = [](const std::string& corners) {
    return R"({"type": "Polygon", "coordinates": [[)" + corners + "]]}";
  };
  const struct {
    std::string text;
    std::string expected;
  } cases[] = {
      {"{", "is not JSON"},
      {"[]", "FeatureCollection"},
      {R"({"type": "Feature"})", "FeatureCollection"},
      {Collection(good, crs84), "CRS84"},
      {Collection(good, R"("crs": 7, )"), "coordinate system"},
      {Collection(good + ",5"), "feature 2: expected a GeoJSON Feature"},
      {Collection(good + "," + Feature("{}", kLine)), "feature 2: kind is missing"},
      {Collection(Feature("null", kLine)), "feature 1: properties"},
      {Collection(Feature(R"({"kind": "wall"})", kLine)), "kind = \"wall\": must be one of line_occupied, line_free"},
      {Collection(Feature(R"({"kind": "line_free", "class": "fog"})", kLine)), "class = \"fog\": must be one of low"},
      {Collection(Feature(R"({"kind": "line_free", "colour": 1})", kLine)), "unknown member \"colour\""},
      {Collection(Feature(R"({"kind": "line_free", "width_m": -1})", kLine)), "width_m = -1: must be positive"},
      {Collection(Feature(R"({"kind": "line_free", "width_m": "a"})", kLine)), "width_m = \"a\": must be positive"},
      {Collection(Feature(R"({"kind": "area_free", "width_m": 1})", kSquare)), "width_m is for lines"},
      {Collection(Feature(R"({"kind": "area_free", "state": "free"})", kSquare)), "state is for cells"},
      {Collection(Feature(R"({"kind": "cells"})", kSquare)), "state is missing"},
      {Collection(Feature(R"({"kind": "mask_returns", "from_ns": "2026-02-30T10:00:00Z"})", kSquare)),
       "from_ns = \"2026-02-30T10:00:00Z\": must be a scan's stamp in ns or a time in UTC"},
      {Collection(Feature(R"({"kind": "mask_returns", "from_ns": 7, "until_ns": 6})", kSquare)),
       "until_ns = 6: must not come before from_ns"},
      {Collection(Feature(R"({"kind": "forbidden", "from_ns": 7})", kSquare)),
       "are for mask_returns, not for forbidden"},
      {Collection(Feature(line, "null")), "geometry is missing"},
      {Collection(Feature(line, "[]")), "geometry []: line_free needs a LineString"},
      {Collection(Feature(line, kSquare)), "geometry Polygon: line_free needs a LineString"},
      {Collection(Feature(R"({"kind": "forbidden"})", kLine)), "geometry LineString: forbidden needs a Polygon"},
      {Collection(
           Feature(R"({"kind": "adjust"})", R"({"type": "LineString", "coordinates": [[1, 2], [1, 3], [2, 3]]})")),
       "an arrow of adjust has two points"},
      {Collection(Feature(line, R"({"type": "LineString", "coordinates": [[1, 2]]})")), "two points"},
      {Collection(Feature(line, R"({"type": "LineString", "coordinates": [[1, "2"], [1, 3]]})")),
       "coordinate [1,\"2\"]"},
      {Collection(Feature(area, ring("[0,0],[1,0],[1,1]"))), "end where it begins"},
      {Collection(Feature(area, ring("[0,0],[4,4],[4,0],[0,4],[0,0]"))),
       "feature 1: the polygon crosses or touches itself at 2.000 2.000"},
  };
  for (const auto& one : cases) {
    try {
      Read(one.text);
      ADD_FAILURE() << one.text << " was accepted";
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("cars.geojson"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(one.expected), std::string::npos) << error.what();
    }
  }
}

// Whatever stands in the members: an edit or a complaint, never anything else.
TEST(ReadEdits, SurvivesAnyMember) {
  const ScratchFolder scratch;
  const char* const values[] = {"null",
                                "-1",
                                "1e999",
                                "\"\"",
                                "\"glass\"",
                                "[]",
                                "[[]]",
                                "{}",
                                "{\"A\": 3}",
                                "true",
                                "{\"A\": [[5, 1, 99999999999]]}",
                                "[1, 2]",
                                "18446744073709551615"};
  int accepted = 0;
  for (const char* member :
       {"uid", "kind", "class", "state", "width_m", "frame", "sigma_m", "who", "when", "why", "tool", "supersedes",
        "basis", "anchors", "beams", "rev", "from_ns", "until_ns", "geometry"}) {
    for (const char* value : values) {
      const std::string properties = R"({"kind": "line_free", ")" + std::string(member) + "\": " + value + "}";
      WriteFileAtomically(scratch / "cars.geojson", Collection(Feature(properties, kLine)));
      try {
        accepted += static_cast<int>(ReadEdits(scratch / "cars.geojson", "").size());
      } catch (const DataError&) {
      }
    }
  }
  EXPECT_GT(accepted, 30);
}

}  // namespace
}  // namespace formats
