// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/seams.h"

#include <gtest/gtest.h>

#include "survey/grid/coverage.h"
#include "survey/grid/seen_tiles.h"
#include "tests/support/rendered_map.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using test_support::Box;
using test_support::Moved;
using test_support::Polygon;
using test_support::RenderMap;
using test_support::RenderOptions;

const RenderOptions kRender{
    .range_noise_m = 0.01, .range_max_m = 15.0, .p_hit = 0.7, .p_miss = 0.4, .scans_per_stand = 6};

// A hall with pillars, 20 m x 12 m.
std::vector<Polygon> Hall() {
  std::vector<Polygon> solids = {Box(0, 0, 20, 0.3), Box(0, 11.7, 20, 12), Box(0, 0, 0.3, 12), Box(19.7, 0, 20, 12)};
  for (const double x : {4.1, 9.7, 15.3}) {
    for (const double y : {4.3, 8.2}) solids.push_back(Box(x, y, x + 0.5, y + 0.5));
  }
  return solids;
}

std::vector<Polygon> MovedBy(std::vector<Polygon> solids, const Vector2d& by) {
  for (Polygon& solid : solids) solid = Moved(solid, by);
  return solids;
}

const std::vector<Vector2d> kWest = {{3, 2.5}, {7, 6}, {11, 3}};
const std::vector<Vector2d> kEast = {{8, 9.5}, {12, 6.2}, {17, 9}};

TEST(CompareMaps, FindsTheOffsetOfTheSecondMapBelowTheCell) {
  const SiteRaster first = RenderMap(Hall(), kWest, kRender);
  for (const Vector2d& by : {Vector2d(0, 0), Vector2d(0.032, -0.061), Vector2d(-0.15, 0.11), Vector2d(0.25, 0.25)}) {
    std::vector<Vector2d> stands;
    for (const Vector2d& stand : kEast) stands.push_back(stand + by);
    const Seam seam = CompareMaps(first, RenderMap(MovedBy(Hall(), by), stands, kRender), {});
    ASSERT_TRUE(seam.offset) << by.transpose();
    EXPECT_NEAR(seam.offset->x(), by.x(), 0.012);
    EXPECT_NEAR(seam.offset->y(), by.y(), 0.012);
    ASSERT_TRUE(seam.rms_m);
    EXPECT_NEAR(*seam.rms_m, by.norm(), 0.02);
    EXPECT_GE(seam.patches.size(), 3U);
    EXPECT_GT(seam.overlap_area_m2, 100.0);
  }
}

TEST(CompareMaps, AStraightWallTellsOnlyTheOffsetAcross) {
  const std::vector<Polygon> wall = {Box(-100, 10, 100, 10.3)};
  const SiteRaster first = RenderMap(wall, {{0, 5}, {4, 6}}, kRender);
  const SiteRaster second = RenderMap(MovedBy(wall, {0, 0.08}), {{2, 5}, {-3, 6.4}}, kRender);
  const Seam seam = CompareMaps(first, second, {});
  ASSERT_FALSE(seam.patches.empty());
  for (const SeamPatch& patch : seam.patches) {
    EXPECT_EQ(patch.directions, 1);
    EXPECT_NEAR(patch.offset.x(), 0.0, 0.01);
    EXPECT_NEAR(patch.offset.y(), 0.08, 0.025);  // half a cell: the wall lies along the cells
  }
  EXPECT_FALSE(seam.offset);
  EXPECT_FALSE(seam.rms_m);
}

TEST(CompareMaps, TheTwoSidesOfAWallAreNotOneDisplacedFace) {
  // A wall 0.2 m thick divides the hall but for a gap in the east; each map sees its own side of it.
  std::vector<Polygon> solids = {Box(0, 0, 20, 0.3), Box(0, 11.7, 20, 12), Box(0, 0, 0.3, 12), Box(19.7, 0, 20, 12)};
  solids.push_back(Box(0.3, 5.9, 15, 6.1));
  const SiteRaster south = RenderMap(solids, {{6, 3}, {18, 4}}, kRender);
  const SiteRaster north = RenderMap(solids, {{6, 9}, {18, 8}}, kRender);
  const Seam seam = CompareMaps(south, north, {});
  ASSERT_TRUE(seam.offset);
  EXPECT_NEAR(seam.offset->x(), 0, 0.015);
  EXPECT_NEAR(seam.offset->y(), 0, 0.015);
  // Without the gap nothing is common.
  const std::vector<Polygon> wall = {Box(-100, 0, 100, 0.2)};
  EXPECT_TRUE(CompareMaps(RenderMap(wall, {{0, -4}}, kRender), RenderMap(wall, {{0, 4}}, kRender), {}).patches.empty());
}

TEST(CompareMaps, MovedThingsAreContradictions) {
  std::vector<Polygon> with_car = Hall();
  with_car.push_back(Box(6, 2, 8, 3.5));
  const Seam same = CompareMaps(RenderMap(Hall(), kWest, kRender), RenderMap(Hall(), kEast, kRender), {});
  const Seam moved = CompareMaps(RenderMap(with_car, {{9.5, 6}, {5, 6}}, kRender),
                                 RenderMap(Hall(), {{9, 2}, {7, 5.5}, {4, 1.5}}, kRender), {});
  EXPECT_LT(same.first_contradicted_share, 0.01);
  EXPECT_LT(same.second_contradicted_share, 0.01);
  EXPECT_GT(moved.first_contradicted_share, 0.05);
  EXPECT_GT(moved.disagreeing_share, same.disagreeing_share);
  EXPECT_LT(moved.second_contradicted_share, 0.02);
}

// What coverage leaves out of two maps does not count.
TEST(Coverage, ThePartsBothHaveSeenGiveTheSeamOfTheWholeMaps) {
  const SiteRaster first = RenderMap(Hall(), {{3, 2.5}, {7, 6}}, {.range_max_m = 8.0});
  const SiteRaster second = RenderMap(Hall(), {{12, 6.2}, {17, 9}}, {.range_max_m = 8.0});
  const Seam whole = CompareMaps(first, second, {});
  const CommonCoverage common = Coverage(StripsOf(first)).With(Coverage(StripsOf(second)));
  const std::int64_t margin = SeamMarginCells({}, first.cell_size_m);
  const FacedRaster part = FacedTiles(StripsOf(first), {}).Part(common.box, margin);
  const Seam parts = CompareMaps(part, FacedTiles(StripsOf(second), {}).Part(common.box, margin), {});
  EXPECT_LT(part.map.width, first.width * 3 / 4);
  ASSERT_GT(whole.overlap_area_m2, 1.0);
  EXPECT_GE(static_cast<double>(common.max_cells) * first.cell_size_m * first.cell_size_m, whole.overlap_area_m2);
  EXPECT_EQ(parts.overlap_area_m2, whole.overlap_area_m2);
  EXPECT_EQ(parts.first_contradicted_share, whole.first_contradicted_share);
  ASSERT_EQ(parts.patches.size(), whole.patches.size());
  for (std::size_t i = 0; i < parts.patches.size(); ++i) EXPECT_EQ(parts.patches[i].offset, whole.patches[i].offset);
}

TEST(SeenTiles, HoldWhatWasSeenAndGiveAnyPartOfIt) {
  SiteRaster map{.min_column = -70, .min_row = -3, .width = 300, .height = 200};
  map.log_odds.assign(map.Index(0, map.height), kUnknownLogOdds);
  for (int k = 0; k < 40; ++k) map.At((k * 7) % 50, (k * 11) % 60) = static_cast<float>(k);
  map.At(299, 199) = 40.0F;
  const SeenTiles tiles(StripsOf(map));
  EXPECT_LT(tiles.bytes(), map.log_odds.size() * sizeof(float) / 4);
  const SiteRaster whole = tiles.Part({-70, -3, 230, 197}, 5);
  ASSERT_EQ(whole.width, map.width);
  ASSERT_EQ(whole.height, map.height);
  const SiteRaster part = tiles.Part({-60, 10, -40, 20}, 3);
  EXPECT_EQ(part.min_column, -63);
  EXPECT_EQ(part.width, 26);
  EXPECT_EQ(part.height, 16);
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      ASSERT_TRUE(same(whole.At(column, row), map.At(column, row))) << column << " " << row;
      if (!part.Contains(column - 7, row - 10)) continue;
      ASSERT_TRUE(same(part.At(column - 7, row - 10), map.At(column, row))) << column << " " << row;
    }
  }
  EXPECT_EQ(tiles.Part({400, 0, 410, 10}, 3).width, 0);
}

TEST(Coverage, MapsApartHaveNothingInCommon) {
  const SiteRaster a{.min_column = -40, .min_row = -3, .width = 2, .height = 1, .log_odds = {1, kUnknownLogOdds}};
  SiteRaster b = a;
  EXPECT_EQ(Coverage(StripsOf(a)).With(Coverage(StripsOf(b))).max_cells, 1);
  b.min_column = 0;
  EXPECT_EQ(Coverage(StripsOf(a)).With(Coverage(StripsOf(b))).max_cells, 0);
}

TEST(CompareMaps, MapsApartHaveNoSeam) {
  SiteRaster a{.cell_size_m = 0.05, .min_column = 0, .min_row = 0, .width = 2, .height = 2, .log_odds = {1, 1, 1, 1}};
  SiteRaster b = a;
  b.min_column = 2;
  const Seam seam = CompareMaps(a, b, {});
  EXPECT_EQ(seam.overlap_area_m2, 0);
  EXPECT_TRUE(seam.patches.empty());
  EXPECT_FALSE(seam.offset);
}

TEST(CompareMaps, DoesNotDependOnTheArraysOnlyOnTheSiteCells) {
  const SiteRaster first = RenderMap(Hall(), kWest, kRender);
  const SiteRaster second = RenderMap(Hall(), kEast, kRender);
  SiteRaster padded = second;
  padded.min_column -= 13;
  padded.width += 20;
  padded.log_odds.assign(static_cast<std::size_t>(padded.width) * static_cast<std::size_t>(padded.height),
                         kUnknownLogOdds);
  for (int r = 0; r < second.height; ++r) {
    for (int c = 0; c < second.width; ++c) padded.At(c + 13, r) = second.At(c, r);
  }
  const Seam a = CompareMaps(first, second, {});
  const Seam b = CompareMaps(first, padded, {});
  EXPECT_EQ(a.overlap_area_m2, b.overlap_area_m2);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t i = 0; i < a.patches.size(); ++i) EXPECT_EQ(a.patches[i].offset, b.patches[i].offset);
}

}  // namespace
}  // namespace survey
