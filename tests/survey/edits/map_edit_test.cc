// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/map_edit.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

// 40 x 30 cells of 0.1 m from (100, 200), all free.
SiteRaster Field() {
  SiteRaster raster{.cell_size_m = 0.1, .min_column = 1000, .min_row = 2000, .width = 40, .height = 30};
  raster.log_odds.assign(40 * 30, -1.0F);
  return raster;
}

MapEdit Area(std::vector<std::vector<Eigen::Vector2d>> rings, EditKind kind = EditKind::kAreaUnknown) {
  return {.kind = kind, .parts = std::move(rings)};
}

TEST(ApplyEdit, AnAreaSetsTheCellsWhoseCentreItHolds) {
  SiteRaster raster = Field();
  // 1.0 m x 0.5 m less a hole of 0.2 m x 0.2 m.
  const MapEdit edit = Area({{{101.0, 201.0}, {102.0, 201.0}, {102.0, 201.5}, {101.0, 201.5}},
                             {{101.2, 201.2}, {101.4, 201.2}, {101.4, 201.4}, {101.2, 201.4}}});
  EXPECT_EQ(ApplyEdit(edit, &raster), 50 - 4);
  EXPECT_TRUE(std::isnan(raster.At(10, 10)));
  EXPECT_TRUE(std::isnan(raster.At(19, 14)));
  EXPECT_EQ(raster.At(20, 14), -1.0F);
  EXPECT_EQ(raster.At(12, 12), -1.0F);
  EXPECT_EQ(ApplyEdit(edit, &raster), 0) << "a second time nothing changes";
}

TEST(ApplyEdit, AThinLineHasNoGapForABeam) {
  for (const Eigen::Vector2d& end : {Eigen::Vector2d(103.7, 201.9), Eigen::Vector2d(103.03, 202.98),
                                     Eigen::Vector2d(101.0, 202.7), Eigen::Vector2d(103.95, 200.3)}) {
    SiteRaster raster = Field();
    const Eigen::Vector2d begin(100.33, 200.28);
    EXPECT_GT(ApplyEdit({.kind = EditKind::kLineOccupied, .parts = {{begin, end}}}, &raster), 5);
    // From each cell on the line to the next one there is a step over an edge: no two touch at corners alone.
    auto before = raster.CellOf(begin);
    for (int i = 0; i <= 1000; ++i) {
      const auto cell = raster.CellOf(begin + (end - begin) * i / 1000.0);
      if (cell == before) continue;
      const auto wall = [&](std::int64_t c, std::int64_t r) {
        return raster.Contains(c, r) && raster.At(static_cast<int>(c), static_cast<int>(r)) == kEditedLogOdds;
      };
      if ((cell - before).cwiseAbs().sum() == 2) {
        EXPECT_TRUE(wall(cell.x(), before.y()) || wall(before.x(), cell.y()));
      }
      before = cell;
    }
  }
}

TEST(ApplyEdit, AWideLineIsAsWideAsAsked) {
  SiteRaster raster = Field();
  const MapEdit edit{.kind = EditKind::kLineFree, .parts = {{{101.0, 201.5}, {103.0, 201.5}}}, .width_m = 0.4};
  ApplyEdit(edit, &raster);
  int width = 0;
  for (int row = 0; row < 30; ++row) width += raster.At(20, row) == -kEditedLogOdds ? 1 : 0;
  EXPECT_EQ(width, 4);
}

TEST(ApplyEdit, WhatLiesOutsideIsCutOff) {
  SiteRaster raster = Field();
  EXPECT_EQ(ApplyEdit(Area({{{90, 190}, {200, 190}, {200, 300}, {90, 300}}}), &raster), 40 * 30);
  EXPECT_EQ(ApplyEdit(Area({{{90, 190}, {95, 190}, {95, 195}}}, EditKind::kAreaFree), &raster), 0);
}

TEST(ApplyEdit, WhatRobotsAvoidAndWhatTheFrontEndDropsIsNotDrawn) {
  SiteRaster raster = Field();
  for (const EditKind kind : {EditKind::kForbidden, EditKind::kMaskReturns})
    EXPECT_EQ(ApplyEdit(Area({{{101, 201}, {102, 201}, {102, 202}}}, kind), &raster), 0);
  EXPECT_EQ(raster.log_odds, Field().log_odds);
}

TEST(ApplyEdit, SquaresAreTakenOneByOne) {
  SiteRaster raster = Field();
  MapEdit cells = Area({{{101.0, 201.0}, {101.1, 201.0}, {101.1, 201.1}, {101.0, 201.1}},
                        {{103.0, 202.0}, {103.3, 202.0}, {103.3, 202.1}, {103.0, 202.1}}},
                       EditKind::kCells);
  cells.cells_state = CellState::kOccupied;
  EXPECT_EQ(ApplyEdit(cells, &raster), 1 + 3);
  EXPECT_EQ(raster.At(10, 10), kEditedLogOdds);
  EXPECT_EQ(raster.At(32, 20), kEditedLogOdds);
}

TEST(AslamType, FollowsThePaper) {
  EXPECT_EQ(AslamType(ObstacleClass::kHigh), 1);
  EXPECT_EQ(AslamType(ObstacleClass::kGlass), 2);
  EXPECT_EQ(AslamType(ObstacleClass::kDownStairs), 3);
  EXPECT_EQ(AslamType(ObstacleClass::kVirtual), 4);
  EXPECT_EQ(AslamType(ObstacleClass::kTransient), 0);
}

TEST(FindSelfCrossing, TellsSimpleRingsFromCrossedOnes) {
  EXPECT_FALSE(FindSelfCrossing(Area({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {2, 2}}})));
  const auto bow_tie = FindSelfCrossing(Area({{{0, 0}, {4, 4}, {4, 0}, {0, 4}}}));
  ASSERT_TRUE(bow_tie);
  EXPECT_NEAR(bow_tie->x(), 2, 1e-12);
  EXPECT_TRUE(FindSelfCrossing(Area({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{3, 1}, {5, 1}, {5, 2}}})))
      << "hole sticks out";
  EXPECT_TRUE(FindSelfCrossing(Area({{{0, 0}, {4, 0}, {2, 0}, {0, 4}}}))) << "spike";
}

TEST(DistanceToRaster, IsZeroWhereTheyMeet) {
  const SiteRaster raster = Field();  // 100..104, 200..203
  EXPECT_EQ(DistanceToRaster(Area({{{99, 199}, {101, 199}, {101, 201}}}), raster), 0);
  EXPECT_NEAR(DistanceToRaster(Area({{{107, 207}, {110, 207}, {110, 210}}}), raster), 5, 1e-9);
}

}  // namespace
}  // namespace survey
