// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/ray_fan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "survey/grid/line_cells.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Cells = std::set<std::pair<int, int>>;  // column, row
using Points = std::vector<Eigen::Vector2f>;

Cells CellsOf(const CellBits& bits, int first_row, int last_row) {
  Cells cells;
  for (int row = first_row; row <= last_row; ++row) {
    int column = bits.FirstColumn();
    for (std::uint64_t word : bits.Row(row)) {
      for (int i = 0; i < CellBits::kColumns; ++i, ++column, word >>= 1) {
        if ((word & 1) != 0) cells.emplace(column, row);
      }
    }
  }
  return cells;
}

Cells CellsOfFan(const Eigen::Vector2f& origin, const Points& ends) {
  RayFan fan;
  fan.Begin(origin.x(), origin.y());
  Eigen::Vector2f low = origin;
  Eigen::Vector2f high = origin;
  for (const Eigen::Vector2f& end : ends) {
    fan.Add(end.x(), end.y(), static_cast<int>(end.x()), static_cast<int>(end.y()));
    low = low.cwiseMin(end);
    high = high.cwiseMax(end);
  }
  const Eigen::Vector2i first = (low.cast<int>().array() - 1).max(0);
  const Eigen::Vector2i last = high.cast<int>().array() + 1;
  CellBits crossed;
  crossed.Reset(first.y(), last.y(), first.x(), last.x());
  fan.Mark(&crossed);
  return CellsOf(crossed, first.y(), last.y());
}

Cells CellsOfRays(const Eigen::Vector2f& origin, const Points& ends) {
  Cells cells;
  for (const Eigen::Vector2f& end : ends)
    ForEachCellOnLine(origin, end, [&](int column, int row) { cells.emplace(column, row); });
  return cells;
}

// Distance from a corner of the cell to the nearest ray, in cells: rounding decides which side of a corner is passed.
double DistanceOfCorners(const std::pair<int, int>& cell, const Eigen::Vector2f& origin, const Points& ends) {
  double nearest = 1e9;
  for (const Eigen::Vector2f& end : ends) {
    const Eigen::Vector2d direction = (end - origin).cast<double>();
    for (const int dx : {0, 1}) {
      for (const int dy : {0, 1}) {
        const Eigen::Vector2d corner = Eigen::Vector2d(cell.first + dx, cell.second + dy) - origin.cast<double>();
        nearest =
            std::min(nearest, std::abs(corner.x() * direction.y() - corner.y() * direction.x()) / direction.norm());
      }
    }
  }
  return nearest;
}

void ExpectSameCells(const Eigen::Vector2f& origin, const Points& ends) {
  const Cells fan = CellsOfFan(origin, ends);
  const Cells rays = CellsOfRays(origin, ends);
  for (const auto& cell : fan) {
    if (rays.contains(cell)) continue;
    EXPECT_LT(DistanceOfCorners(cell, origin, ends), 1e-3) << "only the fan: " << cell.first << " " << cell.second;
  }
  for (const auto& cell : rays) {
    if (fan.contains(cell)) continue;
    EXPECT_LT(DistanceOfCorners(cell, origin, ends), 1e-3) << "only the rays: " << cell.first << " " << cell.second;
  }
  EXPECT_GE(fan.size(), ends.size() / 100);
}

// Ends of a scan all around: walls of a rectangle with steps, a few near posts, beams in order of their angles.
Points RoomScan(const Eigen::Vector2f& origin, int num_beams, double begin_rad, double width_rad,
                const RandomStream& random) {
  Points ends;
  double range = 60.0;
  for (int i = 0; i < num_beams; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    if (random.Uniform(4 * index) < 0.03) range = random.Uniform(4 * index + 1, 3.0, 190.0);  // a depth step
    const double noisy = range + random.Uniform(4 * index + 2, -0.6, 0.6);
    const double angle = begin_rad + width_rad * i / num_beams;
    ends.emplace_back(origin.x() + static_cast<float>(noisy * std::cos(angle)),
                      origin.y() + static_cast<float>(noisy * std::sin(angle)));
  }
  return ends;
}

TEST(RayFan, CrossesTheCellsOfRayTracing) {
  const int beams[] = {5, 60, 180, 361, 1081};
  for (std::uint32_t scan = 0; scan < 60; ++scan) {
    const RandomStream random(5, 1, scan);
    const Eigen::Vector2f origin(static_cast<float>(random.Uniform(900001, 200, 210)),
                                 static_cast<float>(random.Uniform(900002, 200, 210)));
    const double width = random.Uniform(900003, 0.5, 2.0 * std::numbers::pi);
    SCOPED_TRACE(scan);
    ExpectSameCells(origin, RoomScan(origin, beams[scan % 5], random.Uniform(900004, -4, 4), width, random));
  }
}

TEST(RayFan, TakesRaysInAnyOrder) {
  for (std::uint32_t scan = 0; scan < 20; ++scan) {
    const RandomStream random(5, 2, scan);
    const Eigen::Vector2f origin(100.25F, 100.5F);
    Points ends;
    for (std::uint64_t i = 0; i < 40; ++i) {
      ends.emplace_back(static_cast<float>(200 * random.Uniform(2 * i)),
                        static_cast<float>(200 * random.Uniform(2 * i + 1)));
    }
    SCOPED_TRACE(scan);
    ExpectSameCells(origin, ends);
  }
}

TEST(RayFan, HoldsOnCellBordersAndAlongAxes) {
  const Eigen::Vector2f origin(10.0F, 10.0F);
  EXPECT_EQ(CellsOfFan(origin, {{14.0F, 10.0F}}), (Cells{{10, 10}, {11, 10}, {12, 10}, {13, 10}}));
  EXPECT_EQ(CellsOfFan(origin, {{7.5F, 10.0F}}), (Cells{{10, 10}, {9, 10}, {8, 10}}));
  EXPECT_EQ(CellsOfFan(origin, {{10.0F, 13.0F}}), (Cells{{10, 10}, {10, 11}, {10, 12}}));
  EXPECT_EQ(CellsOfFan(origin, {{10.0F, 7.5F}}), (Cells{{10, 10}, {10, 9}, {10, 8}}));
  EXPECT_TRUE(CellsOfFan(origin, {{10.5F, 10.5F}}).empty());
  EXPECT_TRUE(CellsOfFan(origin, {}).empty());
}

TEST(RayFan, ClaimsNothingBehindTheNearerOfTwoEnds) {
  // A wall 100 cells away, hidden behind a post for five of the beams.
  Points ends;
  const Eigen::Vector2f origin(150.5F, 150.5F);
  for (int i = -200; i <= 200; ++i) {
    const float reach = i >= 0 && i < 5 ? 20.0F : 100.0F;
    ends.emplace_back(origin.x() + reach * static_cast<float>(i) * 0.004F, origin.y() + reach);
  }
  const Cells cells = CellsOfFan(origin, ends);
  EXPECT_FALSE(cells.contains({151, 240}));
  EXPECT_TRUE(cells.contains({151, 165}));
  EXPECT_TRUE(cells.contains({149, 240}));
  EXPECT_TRUE(cells.contains({154, 240}));
}

}  // namespace
}  // namespace survey
