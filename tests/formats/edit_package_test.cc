// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_package.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using survey::EditKind;
using survey::MapEdit;

MapEdit Edit(const std::string& uid, EditKind kind, std::vector<std::vector<Eigen::Vector2d>> parts) {
  MapEdit edit{.uid = uid, .revision = 3, .kind = kind, .parts = std::move(parts)};
  edit.who = "AB";
  edit.when = "2026-11-28T10:15:00Z";
  edit.why = "seen on Friday";
  return edit;
}

class EditPackageTest : public testing::Test {
 protected:
  EditPackageTest() {
    MapEdit wall = Edit("wall", EditKind::kLineOccupied, {{{500000.1234, 5600000}, {500003, 5600004}}});
    wall.width_m = 0.2;
    wall.obstacle = survey::ObstacleClass::kGlass;
    const MapEdit yard = Edit("yard", EditKind::kForbidden,
                              {{{500010, 5600000}, {500020, 5600000}, {500020, 5600010}},
                               {{500017, 5600002}, {500018, 5600002}, {500018, 5600003}}});
    MapEdit cells = Edit("cells", EditKind::kCells, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
    cells.cells_state = survey::CellState::kFree;
    RasterLabel label{.frame = {.crs = "EPSG:25832", .wkt2 = ""}, .tied = true};
    WriteEditPackage(file_, {wall, yard, cells}, {{"A", "60de"}}, label);
  }

  // As QGIS does it: SQL on the layers.
  void Sql(const std::string& statement) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(
        GDALDataset::Open(file_.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE, nullptr, nullptr, nullptr));
    ASSERT_NE(data, nullptr);
    data->ReleaseResultSet(data->ExecuteSQL(statement.c_str(), nullptr, nullptr));
  }

  test_support::ScratchFolder scratch_;
  std::filesystem::path file_ = scratch_ / "office.gpkg";
};

TEST_F(EditPackageTest, LookingAtItChangesNothing) {
  EXPECT_TRUE(ReadEditPackage(file_).empty());
  Sql("VACUUM");
  EXPECT_TRUE(ReadEditPackage(file_).empty()) << "other bytes, same content";
}

TEST_F(EditPackageTest, MovedGoneAndNewByUid) {
  Sql("UPDATE edit_lines SET width_m = 0.4 WHERE uid = 'wall'");
  Sql("DELETE FROM edit_areas WHERE uid = 'yard'");
  Sql("INSERT INTO edit_lines (geom, kind, frame) SELECT geom, 'line_free', 'site' FROM edit_lines WHERE uid = 'wall'");
  const std::vector<LedgerLine> lines = ReadEditPackage(file_);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].operation, LedgerOperation::kModify);
  EXPECT_EQ(lines[0].edit.uid, "wall");
  EXPECT_EQ(lines[0].edit.revision, 4);
  EXPECT_EQ(lines[0].edit.width_m, 0.4);
  EXPECT_EQ(lines[0].edit.obstacle, survey::ObstacleClass::kGlass);
  EXPECT_EQ(lines[0].edit.basis.at("A"), "60de");
  EXPECT_EQ(lines[1].operation, LedgerOperation::kAdd);
  EXPECT_EQ(lines[1].edit.kind, EditKind::kLineFree);
  EXPECT_EQ(lines[1].edit.frame, survey::EditFrame::kSite);
  EXPECT_EQ(lines[1].edit.uid, ReadEditPackage(file_)[1].edit.uid) << "the same feature is the same edit";
  EXPECT_EQ(lines[1].edit.uid.size(), 12U);
  EXPECT_EQ(lines[2].operation, LedgerOperation::kRetire);
  EXPECT_EQ(lines[2].edit.uid, "yard");
  EXPECT_EQ(lines[2].edit.revision, 4);
}

TEST_F(EditPackageTest, AMaskMayHoldForATime) {
  Sql("UPDATE edit_areas SET kind = 'mask_returns', from_ns = '1970-01-01T00:16:40Z', until_ns = '1003000000000' WHERE "
      "uid = 'yard'");
  const std::vector<LedgerLine> lines = ReadEditPackage(file_);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].edit.from_ns, 1000000000000);
  EXPECT_EQ(lines[0].edit.until_ns, 1003000000000);
}

TEST_F(EditPackageTest, WhatWasDrawnWronglyIsNamed) {
  const auto refusal = [&] {
    try {
      ReadEditPackage(file_);
      return std::string();
    } catch (const DataError& error) {
      return std::string(error.what());
    }
  };
  Sql("UPDATE edit_lines SET kind = 'wall'");
  EXPECT_NE(refusal().find("office.gpkg: edit_lines 1: kind = \"wall\": must be one of"), std::string::npos)
      << refusal();
  Sql("UPDATE edit_lines SET kind = 'forbidden'");
  EXPECT_NE(refusal().find("forbidden needs a Polygon"), std::string::npos) << refusal();
  Sql("UPDATE edit_lines SET kind = 'line_free', uid = 'yard'");
  EXPECT_NE(refusal().find("uid = yard: the same as of"), std::string::npos) << refusal();
  WriteFileAtomically(file_, "no package");
  EXPECT_NE(refusal().find("cannot be read as GeoPackage"), std::string::npos) << refusal();
}

TEST_F(EditPackageTest, BringsTheFormForQgis) {
  GDALAllRegister();
  const GDALDatasetUniquePtr data(GDALDataset::Open(file_.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  OGRLayer* styles = data->ExecuteSQL(
      "SELECT styleQML, useAsDefault FROM layer_styles WHERE f_table_name = "
      "'edit_areas'",
      nullptr, nullptr);
  ASSERT_NE(styles, nullptr);
  const OGRFeatureUniquePtr row(styles->GetNextFeature());
  ASSERT_NE(row, nullptr);
  const std::string qml = row->GetFieldAsString(0);
  EXPECT_EQ(row->GetFieldAsInteger(1), 1);
  for (const char* part : {"value=\"mask_returns\"", "name=\"down stairs (type 3)\"", "WithoutBraces",
                           "masked from (UTC or stamp)", "<constraint field=\"kind\" constraints=\"1\""})
    EXPECT_NE(qml.find(part), std::string::npos) << part;
  EXPECT_EQ(qml.find("line_occupied"), std::string::npos) << "not of areas";
  data->ReleaseResultSet(styles);
}

}  // namespace
}  // namespace formats
