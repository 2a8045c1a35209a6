// SPDX-License-Identifier: Apache-2.0
#include "survey/planning/robot_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/edits/keepout.h"

namespace survey {
namespace {

using Eigen::Vector2d;

// A hall of 10 m x 6 m with a wall across it at x = 5, open from y = 4 on, and a door of 1 m at y = 1.
SiteRaster Hall() {
  SiteRaster hall{.cell_size_m = 0.1, .min_column = 0, .min_row = 0, .width = 100, .height = 60};
  hall.log_odds.assign(6000, -2.0F);
  for (int row = 0; row < 40; ++row) {
    if (row < 5 || row >= 15) hall.At(50, row) = 2.0F;
  }
  return hall;
}

const Vector2d kStart(2.05, 1.05);
const Vector2d kGoal(8.05, 1.05);

TEST(RobotSpace, GoesStraightThroughTheDoor) {
  const RobotSpace space(Hall(), {.radius_m = 0.3});
  const auto path = space.Path(kStart, kGoal);
  ASSERT_FALSE(path.empty());
  EXPECT_NEAR(LengthOf(path), 6.0, 1e-6);
  EXPECT_NEAR(space.ClearanceAt({5.05, 1.05}), 0.55, 0.1);
}

// [AS] figure 12: the same goal after the door was forbidden.
TEST(RobotSpace, GoesRoundAForbiddenDoorOrNotAtAll) {
  SiteRaster hall = Hall();
  const MapEdit door{.kind = EditKind::kForbidden, .parts = {{{4.8, 0.4}, {5.3, 0.4}, {5.3, 1.6}, {4.8, 1.6}}}};
  ForEachCell(door, hall, [&](int column, int row) { hall.At(column, row) = kEditedLogOdds; });
  const RobotSpace space(hall, {.radius_m = 0.3});
  // By the octile metric round the end of the wall: between the straight lines and the box.
  const double length = LengthOf(space.Path(kStart, kGoal));
  EXPECT_GT(length, 2.0 * std::hypot(3.0, 3.2));
  EXPECT_LT(length, 2.0 * (3.0 + 3.4));
  EXPECT_TRUE(RobotSpace(hall, {.radius_m = 1.2}).Path(kStart, kGoal).empty()) << "too wide for the rest";
}

TEST(RobotSpace, UnknownCellsAndTheRimAreWalls) {
  SiteRaster hall = Hall();
  for (int row = 0; row < 60; ++row) hall.At(70, row) = NAN;
  const RobotSpace space(hall, {.radius_m = 0.2});
  EXPECT_TRUE(space.Path(kStart, kGoal).empty());
  EXPECT_NEAR(space.ClearanceAt({0.05, 3.05}), 0.1, 1e-6);
  EXPECT_EQ(space.ClearanceAt({-1, 3}), 0.0);
}

TEST(KeepoutStrips, AreOccupiedInForbiddenAreasAlone) {
  const MapEdit area{.kind = EditKind::kForbidden, .parts = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}}};
  const RasterStrips strips = KeepoutStrips(FrameOf(Hall()), {area});
  const SiteRaster rows = strips.read(10, 20);
  int forbidden = 0;
  for (const float cell : rows.log_odds) forbidden += cell > 0.0F ? 1 : 0;
  EXPECT_EQ(forbidden, 100);
  EXPECT_GT(rows.At(15, 5), 0.0F);
}

}  // namespace
}  // namespace survey
