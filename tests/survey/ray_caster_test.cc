// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/ray_caster.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "survey/stats/philox.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector2d;

Vector2d DirectionOf(double angle) { return {std::cos(angle), std::sin(angle)}; }

TEST(RayCaster, RangesInARectangularRoomAreAnalytic) {
  const RayCaster room(BuildFloorPlan(test_support::RoomScenario()));
  const Vector2d origin(7.3, 5.1);
  for (int i = 0; i < 720; ++i) {
    const Vector2d u = DirectionOf(i * std::numbers::pi / 360.0);
    const double x_wall = std::abs(u.x()) < 1e-12 ? 1e9 : ((u.x() > 0 ? 24.0 : 0.0) - origin.x()) / u.x();
    const double y_wall = std::abs(u.y()) < 1e-12 ? 1e9 : ((u.y() > 0 ? 16.0 : 0.0) - origin.y()) / u.y();
    EXPECT_NEAR(room.Cast(origin, u, 100.0).range_m, std::min(x_wall, y_wall), 1e-9) << i;
  }
  EXPECT_TRUE(std::isinf(room.Cast(origin, {1.0, 0.0}, 16.0).range_m));
  EXPECT_NEAR(room.Clearance(origin, 10.0), 5.1, 1e-9);
  EXPECT_NEAR(room.Clearance(origin, 3.0), 3.0, 1e-9);
}

// A second method: every shape, each by solving the linear or quadratic equation.
class BruteForce {
 public:
  explicit BruteForce(FloorPlan plan) : plan_(std::move(plan)) {}

  double Range(const Vector2d& origin, const Vector2d& u) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto* faces : {&plan_.solid_faces, &plan_.car_faces}) {
      for (const Face& face : *faces) nearest = std::min(nearest, ToSegment(origin, u, face.a, face.b));
    }
    for (const auto* discs : {&plan_.pillar_discs, &plan_.car_discs}) {
      for (const Disc& disc : *discs) {
        const double b = u.dot(origin - disc.centre);
        const double c = (origin - disc.centre).squaredNorm() - disc.radius_m * disc.radius_m;
        if (b * b >= c && c > 0 && -b - std::sqrt(b * b - c) > 0)
          nearest = std::min(nearest, -b - std::sqrt(b * b - c));
      }
    }
    return nearest;
  }

  std::vector<double> PaneRanges(const Vector2d& origin, const Vector2d& u, double before) const {
    std::vector<double> ranges;
    for (const Pane& pane : plan_.panes) {
      const double range = ToSegment(origin, u, pane.a, pane.b);
      if (range < before) ranges.push_back(range);
    }
    std::sort(ranges.begin(), ranges.end());
    return ranges;
  }

 private:
  static double ToSegment(const Vector2d& origin, const Vector2d& u, const Vector2d& a, const Vector2d& b) {
    Eigen::Matrix2d m;
    m << u, a - b;
    if (std::abs(m.determinant()) < 1e-12) return std::numeric_limits<double>::infinity();
    const Vector2d solution = m.inverse() * (a - origin);
    const bool hit = solution[0] > 0 && solution[1] >= 0 && solution[1] <= 1;
    return hit ? solution[0] : std::numeric_limits<double>::infinity();
  }

  FloorPlan plan_;
};

TEST(RayCaster, AgreesWithAllShapesTriedOneByOne) {
  Scenario scenario = test_support::RoomScenario();
  scenario.pillar_grids.push_back(
      {.first = {3.0, 3.0}, .step = {4.5, 5.0}, .columns = 5, .rows = 3, .size_m = 0.5, .without = {"C2"}});
  scenario.pillars.push_back({.name = "round", .centre = {11.0, 8.0}, .size_m = 0.7, .round = true});
  scenario.parking_rows.push_back({.name = "row", .from = {1.0, 13.0}, .to = {23.0, 13.0}, .occupancy = 0.8});
  scenario.cars.push_back({.centre = {8.0, 10.0}, .heading_rad = 0.4});
  scenario.glass.push_back({.line = {{5.0, 6.0}, {9.0, 6.5}, {9.5, 1.0}}, .response = 0.3});
  const FloorPlan plan = BuildFloorPlan(scenario);
  ASSERT_EQ(plan.pillars.size(), 15U);
  ASSERT_GT(plan.cars.size(), 3U);
  const RayCaster caster(plan);
  const BruteForce truth(plan);

  const RandomStream random(1, 2, 3);
  int with_panes = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto [x, y] = random.Uniforms(2 * i);
    const Vector2d origin(0.2 + 23.5 * x, 0.2 + 15.5 * y);
    const Vector2d u = DirectionOf(2.0 * std::numbers::pi * random.Uniform(2 * i + 1));
    const RayHit hit = caster.Cast(origin, u, 60.0);
    const double expected = truth.Range(origin, u);
    ASSERT_NEAR(hit.range_m, expected, 1e-9) << origin.transpose() << " towards " << u.transpose();
    const std::vector<double> panes = truth.PaneRanges(origin, u, expected);
    ASSERT_EQ(static_cast<std::size_t>(hit.num_panes), panes.size());
    for (std::size_t k = 0; k < panes.size(); ++k) {
      EXPECT_NEAR(hit.panes[k].range_m, panes[k], 1e-9);
      EXPECT_EQ(hit.panes[k].response, 0.3);
      ++with_panes;
    }
  }
  EXPECT_GT(with_panes, 500);
}

TEST(FloorPlan, RepeatedRowsDrawTheirOwnCars) {
  Scenario scenario;
  scenario.parking_rows.push_back({.name = "row",
                                   .from = {0.0, 0.0},
                                   .to = {27.0, 0.0},
                                   .step = {30.0, 20.0},
                                   .columns = 3,
                                   .rows = 2,
                                   .occupancy = 0.5,
                                   .without = {"B1"}});
  const std::vector<Car> cars = BuildFloorPlan(scenario).cars;
  const auto count = [&](double x, double y) {
    return std::count_if(cars.begin(), cars.end(), [&](const Car& car) {
      return car.centre.x() > x && car.centre.x() < x + 30.0 && std::abs(car.centre.y() - y) < 2.0;
    });
  };
  EXPECT_EQ(count(30.0, 0.0), 0);
  EXPECT_GT(count(0.0, 0.0), 0);
  EXPECT_GT(count(60.0, 20.0), 0);
  EXPECT_GT(cars.size(), 10U);
  EXPECT_LT(cars.size(), 40U);
  // The same stall of another line is another draw.
  std::vector<double> lengths;
  for (const Car& car : cars) lengths.push_back(car.length_m);
  std::sort(lengths.begin(), lengths.end());
  EXPECT_EQ(std::adjacent_find(lengths.begin(), lengths.end()), lengths.end());
}

TEST(FloorPlan, CornersAndCarsThatWouldTouchAPillar) {
  Scenario scenario = test_support::RoomScenario();
  scenario.walls.push_back({.line = {{4.0, 8.0}, {10.0, 8.0}}, .thickness_m = 0.2});
  scenario.parking_rows.push_back({.name = "row", .from = {0.8, 13.0}, .to = {25.1, 13.0}, .occupancy = 1.0});
  const std::size_t without_pillar = BuildFloorPlan(scenario).cars.size();
  EXPECT_EQ(without_pillar, 8U);  // the ninth stall reaches into the wall
  scenario.pillars.push_back({.name = "P", .centre = {4.0, 13.0}, .size_m = 0.6});
  const FloorPlan plan = BuildFloorPlan(scenario);
  EXPECT_EQ(plan.cars.size(), without_pillar - 1);

  EXPECT_TRUE(IsCorner(plan, {0.0, 16.0}));    // of the room
  EXPECT_TRUE(IsCorner(plan, {4.0, 7.9}));     // free end of a wall
  EXPECT_TRUE(IsCorner(plan, {3.7, 13.3}));    // of the pillar
  EXPECT_FALSE(IsCorner(plan, {4.0, 13.0}));   // inside it
  EXPECT_FALSE(IsCorner(plan, {7.0, 7.9}));    // on a straight face
  EXPECT_FALSE(IsCorner(plan, {4.0, 7.895}));  // beside the corner
}

}  // namespace
}  // namespace survey
