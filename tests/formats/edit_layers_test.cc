// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_layers.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "formats/vector_files.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using survey::AppliedEdit;
using survey::EditKind;
using survey::EditState;
using survey::FindingKind;

AppliedEdit Edit(const std::string& uid, EditKind kind, std::vector<std::vector<Eigen::Vector2d>> parts) {
  AppliedEdit applied{.edit = {.uid = uid, .kind = kind, .parts = std::move(parts)}};
  applied.edit.who = "AB";
  applied.edit.when = "2026-11-28T10:15:00Z";
  applied.edit.why = "seen on Friday";
  return applied;
}

// A wall that holds, a free place that newer scans contradict, a forbidden yard that was taken back.
std::vector<survey::SiteEdit> Edits() {
  const survey::BlockEdits block{
      .block = "B1",
      .edits = {Edit("wall", EditKind::kLineOccupied, {{{500000, 5600000}, {500003, 5600004}}}),
                Edit("place", EditKind::kAreaFree, {{{500005, 5600000}, {500006, 5600000}, {500006, 5600001}}})},
      .findings = {{FindingKind::kStale, {"place"}, "newer scans contradict it"},
                   {FindingKind::kEditReview, {"place", "wall"}, "the map was bent"}}};
  std::vector<survey::SiteEdit> edits = survey::SiteEdits({&block, 1});
  edits.push_back({Edit("yard", EditKind::kForbidden,
                        {{{500010, 5600000}, {500020, 5600000}, {500020, 5600010}},
                         {{500017, 5600002}, {500018, 5600002}, {500018, 5600003}}}),
                   EditState::kRetired, "taken back by CD"});
  return edits;
}

class EditLayersTest : public testing::Test {
 protected:
  EditLayersTest() {
    const RasterLabel label{.frame = {.crs = "EPSG:25832", .wkt2 = ""}, .tied = true};
    WriteGeoPackage(scratch_ / "site.gpkg", EditLayers(Edits()), label, {.records = {{.stage = "report"}}});
    GDALAllRegister();
    data_.reset(GDALDataset::Open((scratch_ / "site.gpkg").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  }

  // Values of a column, a line each.
  std::string Select(const std::string& query) {
    OGRLayer* rows = data_->ExecuteSQL(query.c_str(), nullptr, nullptr);
    std::string text;
    while (const OGRFeatureUniquePtr row{rows->GetNextFeature()}) text += std::string(row->GetFieldAsString(0)) + "\n";
    data_->ReleaseResultSet(rows);
    return text;
  }

  test_support::ScratchFolder scratch_;
  GDALDatasetUniquePtr data_;
};

TEST_F(EditLayersTest, TellWhoDrewWhatAndWhetherItHolds) {
  const std::string told =
      "SELECT uid || ' ' || kind || ' ' || state || ', ' || who || ' ' || why || ', ' || remark FROM ";
  EXPECT_EQ(Select(told + "edit_lines"), "wall line_occupied active, AB seen on Friday, the map was bent\n");
  EXPECT_EQ(Select(told + "edit_areas"),
            "place area_free stale, AB seen on Friday, newer scans contradict it; the map was bent\n"
            "yard forbidden retired, AB seen on Friday, taken back by CD\n");
  OGRLayer* areas = data_->GetLayerByName("edit_areas");
  const OGRFeatureUniquePtr yard(areas->GetFeature(2));
  EXPECT_EQ(yard->GetGeometryRef()->toPolygon()->getNumInteriorRings(), 1);
}

TEST_F(EditLayersTest, EachKindAndStateHasAStyleInTheFile) {
  const std::string areas = Select("SELECT styleQML FROM layer_styles WHERE f_table_name = 'edit_areas'");
  const std::string lines = Select("SELECT styleQML FROM layer_styles WHERE f_table_name = 'edit_lines'");
  EXPECT_NE(areas.find("type=\"categorizedSymbol\" attr=\"if(&quot;state&quot; = 'active'"), std::string::npos)
      << areas;
  for (const EditKind kind : survey::kEditKinds) {
    const std::string category = " value=\"" + std::string(Name(kind)) + "\" ";
    EXPECT_EQ(areas.find(category) != std::string::npos, IsArea(kind)) << category;
    EXPECT_EQ(lines.find(category) != std::string::npos, !IsArea(kind)) << category;
  }
  for (const char* state : {" value=\"stale\" ", " value=\"retired\" "}) {
    EXPECT_NE(areas.find(state), std::string::npos) << state;
    EXPECT_NE(lines.find(state), std::string::npos) << state;
  }
}

}  // namespace
}  // namespace formats
