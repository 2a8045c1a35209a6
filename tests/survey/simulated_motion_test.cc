// SPDX-License-Identifier: Apache-2.0
//
// Routes, the exact motion and its derivatives.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "survey/simulation/route.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector3d;

RoutePlan PlanFirst(const Scenario& scenario) {
  return PlanRoute(scenario, scenario.blocks.front(), RayCaster(BuildFloorPlan(scenario)));
}

Scenario OffsetRoom() {
  Scenario scenario = test_support::RoomScenario();
  scenario.cart.body_from_lidar = {0.4, -0.1, 0.6};
  scenario.cart.floor_tilt_rad = 0.01;
  return scenario;
}

// Rotation vector of the small turn from a to b, seen in a, over the time between.
Vector3d RateBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double seconds) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.transpose() * b));
  return turn.angle() / seconds * turn.axis();
}

TEST(Trajectory, RatesAndAccelerationsAreDerivatives) {
  const Scenario scenario = OffsetRoom();
  const RoutePlan plan = PlanFirst(scenario);
  ASSERT_TRUE(plan.trajectory);
  const Trajectory& trajectory = *plan.trajectory;
  const double h = 1e-4;
  for (double t = trajectory.start_s() + 0.53; t < trajectory.end_s() - 0.5; t += 0.71) {
    const auto position = [&](double time) { return Vector3d(trajectory.PlanFromBody(time).translation()); };
    const Vector3d velocity = (position(t + h) - position(t - h)) / (2 * h);
    EXPECT_LT((velocity - trajectory.BodyVelocity(t)).norm(), 1e-6) << t;
    const Vector3d acceleration = (position(t + h) - 2 * position(t) + position(t - h)) / (h * h);
    EXPECT_LT((acceleration - trajectory.BodyAcceleration(t)).norm(), 2e-3) << t;
    const Eigen::Matrix3d before = trajectory.PlanFromBody(t - h).linear();
    const Eigen::Matrix3d after = trajectory.PlanFromBody(t + h).linear();
    const MotionState state = trajectory.At(t);
    EXPECT_LT((RateBetween(before, after, 2 * h) - state.AngularRateInBody()).norm(), 1e-5) << t;
    const Vector3d rate_change =
        (trajectory.At(t + h).AngularRateInBody() - trajectory.At(t - h).AngularRateInBody()) / (2 * h);
    EXPECT_LT((rate_change - state.AngularAccelerationInBody()).norm(), 1e-3) << t;
  }
}

TEST(Trajectory, LidarStandsWhereTheMountingPutsIt) {
  const Scenario scenario = OffsetRoom();
  const RoutePlan plan = PlanFirst(scenario);
  const double t = 117.3;
  const Pose2 lidar = plan.trajectory->PlanarPlanFromLidar(t);
  const Pose2 again = plan.trajectory->PlanarPlanFromBody(t) * scenario.cart.body_from_lidar;
  EXPECT_NEAR(lidar.x, again.x, 1e-9);
  EXPECT_NEAR(lidar.y, again.y, 1e-9);
  EXPECT_NEAR(NormalizeAngle(lidar.theta - again.theta), 0.0, 1e-9);
}

TEST(Route, KeepsTheCartsLimits) {
  const Scenario scenario = test_support::RoomScenario();
  const RoutePlan plan = PlanFirst(scenario);
  ASSERT_TRUE(plan.trajectory) << plan.problem;
  double fastest = 0.0;
  double turning = 0.0;
  for (double t = plan.trajectory->start_s(); t < plan.trajectory->end_s(); t += 0.01) {
    const MotionState state = plan.trajectory->At(t);
    fastest = std::max(fastest, state.first.head<2>().norm());
    turning = std::max(turning, std::abs(state.first[3]));
    EXPECT_LT(
        std::abs(state.first.head<2>().dot(state.second.head<2>())) / std::max(0.05, state.first.head<2>().norm()),
        1.1 * scenario.cart.acceleration_m_s2)
        << t;
    // Where it moves, the body points along the way.
    if (state.first.head<2>().norm() > 0.3) {
      const double along = std::atan2(state.first.y(), state.first.x());
      EXPECT_NEAR(NormalizeAngle(along - state.value[3]), 0.0, 0.02) << t;
    }
  }
  EXPECT_LE(fastest, scenario.cart.speed_m_s + 1e-3);
  EXPECT_GT(fastest, 0.95 * scenario.cart.speed_m_s);
  EXPECT_LE(turning, 1.01 * scenario.cart.turn_rate_rad_s);
  EXPECT_GT(turning, 0.4);
  // 14 + 14 + 7 + 8 m between the waypoints less what the corners cut.
  EXPECT_GT(plan.length_m, 40.0);
  EXPECT_LT(plan.length_m, 44.0);
}

TEST(Route, TurnsOnTheSpotNoFasterThanTheCartCan) {
  Scenario scenario = test_support::RoomScenario();
  scenario.blocks.front().waypoints = {
      {{12.0, 4.0}, "A"}, {{12.0, 10.0}, "B"}, {{12.0, 4.0}, "A"}, {{12.0, 10.0}, "B"}, {{12.0, 4.0}, "A"}};
  const RoutePlan plan = PlanFirst(scenario);
  ASSERT_TRUE(plan.trajectory) << plan.problem;
  double turning = 0.0;
  for (double t = plan.trajectory->start_s(); t < plan.trajectory->end_s(); t += 0.01) {
    turning = std::max(turning, std::abs(plan.trajectory->At(t).first[3]));
  }
  EXPECT_LE(turning, 1.01 * scenario.cart.turn_rate_rad_s);
}

TEST(Route, StandsStillOverThePointsWithinTheCentringError) {
  Scenario scenario = test_support::RoomScenario();
  // Twenty visits of each point.
  std::vector<Waypoint>& waypoints = scenario.blocks.front().waypoints;
  waypoints = {{{12.0, 4.0}, "A"}};
  for (int i = 0; i < 20; ++i) {
    waypoints.push_back({{18.0, 8.0}, "B"});
    waypoints.push_back({{12.0, 4.0}, "A"});
  }
  const RoutePlan plan = PlanFirst(scenario);
  ASSERT_EQ(plan.stops.size(), 41U);
  double squares = 0.0;
  for (const Stop& stop : plan.stops) {
    const Pose2 start = plan.trajectory->PlanarPlanFromLidar(stop.start_s);
    const Pose2 end = plan.trajectory->PlanarPlanFromLidar(stop.end_s);
    EXPECT_NEAR(stop.end_s - stop.start_s, scenario.stop_s - 0.6, 1e-9);
    EXPECT_LT((start.Translation() - end.Translation()).norm(), 1e-12) << stop.point;
    EXPECT_NEAR(start.theta, end.theta, 1e-12);
    EXPECT_LT(plan.trajectory->At(stop.start_s).first.norm(), 1e-12);
    const Eigen::Vector2d point = scenario.points[stop.point == "A" ? 0 : 1].position;
    squares += (start.Translation() - point).squaredNorm();
  }
  const double sigma = std::sqrt(squares / (2 * 41));
  EXPECT_NEAR(sigma, scenario.centring_sigma_m, 4.0 * scenario.centring_sigma_m / std::sqrt(2.0 * 82));
}

TEST(Route, TheWayThroughAWallIsRefused) {
  Scenario scenario = test_support::RoomScenario();
  scenario.walls.push_back({.line = {{10.0, 11.0}, {10.0, 16.0}}, .thickness_m = 0.2});
  const RoutePlan plan = PlanFirst(scenario);
  EXPECT_FALSE(plan.trajectory);
  EXPECT_EQ(plan.problem_waypoint, 6);  // (4, 12), reached through the wall
  EXPECT_NE(plan.problem.find("cannot be reached"), std::string::npos) << plan.problem;
}

TEST(Route, SharpTurnsAndRepeatedPlacesAreRefused) {
  Scenario scenario = test_support::RoomScenario();
  scenario.blocks.front().waypoints = {{{4.0, 4.0}, ""}, {{12.0, 4.0}, ""}, {{5.0, 4.1}, ""}};
  EXPECT_EQ(PlanFirst(scenario).problem_waypoint, 2);
  scenario.blocks.front().waypoints = {{{4.0, 4.0}, ""}, {{4.0, 4.05}, ""}, {{5.0, 9.1}, ""}};
  EXPECT_EQ(PlanFirst(scenario).problem_waypoint, 2);
  scenario.blocks.front().waypoints = {{{4.0, 4.0}, ""}};
  EXPECT_FALSE(PlanFirst(scenario).trajectory);
}

TEST(Floor, SlopeIsTheDerivativeAndHasTheGivenSize) {
  Scenario scenario = test_support::RoomScenario();
  scenario.cart.floor_tilt_rad = 0.005;
  double squares = 0.0;
  int count = 0;
  const double h = 1e-4;
  for (double x = 0.0; x < 200.0; x += 3.7) {
    for (double y = 0.0; y < 200.0; y += 4.1) {
      const Eigen::Vector2d p(x, y);
      const Eigen::Vector2d dx(h, 0.0);
      const Eigen::Vector2d dy(0.0, h);
      const Eigen::Vector2d slope((FloorAt(scenario, p + dx).height_m - FloorAt(scenario, p - dx).height_m) / (2 * h),
                                  (FloorAt(scenario, p + dy).height_m - FloorAt(scenario, p - dy).height_m) / (2 * h));
      EXPECT_LT((slope - FloorAt(scenario, p).slope).norm(), 1e-7);
      squares += slope.squaredNorm();
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.005, 0.0005);
}

}  // namespace
}  // namespace survey
