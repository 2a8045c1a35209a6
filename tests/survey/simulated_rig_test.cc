// SPDX-License-Identifier: Apache-2.0
//
// The sensors of the simulation against their specifications and against second methods.
#include <gtest/gtest.h>

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A scenario with all that its first block's sensors need.
struct World {
  explicit World(Scenario s)
      : scenario(std::move(s)), building(BuildFloorPlan(scenario)), plan(PlanRoute(scenario, Block(), building)) {}
  const BlockRoute& Block() const { return scenario.blocks.front(); }
  const Trajectory& Motion() const { return *plan.trajectory; }
  SimulatedLidar Lidar() const { return {scenario, Block(), building, Motion()}; }

  Scenario scenario;
  RayCaster building;
  RoutePlan plan;
};

// Distance to the upright walls of the room along a beam in space, from the exact pose at the beam's own time.
double ExpectedRange(const World& world, std::int64_t scan, int beam) {
  const ScanGeometry geometry = GeometryOf(world.scenario.lidar);
  const double time = 100.0 + static_cast<double>(scan) * 0.025 + beam * geometry.time_increment_s;
  const Eigen::Isometry3d pose = world.Motion().PlanFromLidar(time);
  const double angle = geometry.angle_min_rad + beam * geometry.angle_increment_rad;
  const Vector3d u = pose.linear() * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  const Vector3d p = pose.translation();
  const auto to_wall = [](double from, double size, double along) {
    return std::abs(along) < 1e-9 ? double{kNoReturn} : ((along > 0 ? size : 0.0) - from) / along;
  };
  return std::min(to_wall(p.x(), 24.0, u.x()), to_wall(p.y(), 16.0, u.y()));
}

TEST(SimulatedLidar, RangesFollowTheMotionWithinTheSweepAndTheTilt) {
  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.cart.floor_tilt_rad = 0.01;
  scenario.cart.body_from_lidar = {0.3, 0.1, -0.4};
  const World world(scenario);
  const SimulatedLidar lidar = world.Lidar();
  ASSERT_GT(lidar.num_scans(), 1500);
  double worst = 0.0;
  for (std::int64_t scan = 0; scan < lidar.num_scans(); scan += 17) {
    EXPECT_EQ(lidar.StampOf(scan), 100000000000 + scan * 25000000);
    const std::vector<float> ranges = lidar.Ranges(scan);
    ASSERT_EQ(ranges.size(), 1081U);
    for (int beam = 0; beam < 1081; beam += 9) {
      const double expected = ExpectedRange(world, scan, beam);
      worst = std::max(worst, std::abs(static_cast<double>(ranges[static_cast<std::size_t>(beam)]) - expected));
    }
  }
  EXPECT_LT(worst, 0.0012);  // half a millimetre of resolution and the tilt kept for the whole sweep
}

TEST(SimulatedLidar, NoiseAndLostEchoesAreAsSpecified) {
  Scenario scenario = test_support::RoomScenario();
  scenario.lidar.dropout_probability = 0.02;
  const World world(scenario);
  const SimulatedLidar lidar = world.Lidar();
  struct Sums {
    double n = 0, sum = 0, squares = 0;
  };
  Sums near;
  Sums far;
  double lost = 0;
  double all = 0;
  for (std::int64_t scan = 0; scan < lidar.num_scans(); scan += 11) {
    const std::vector<float> ranges = lidar.Ranges(scan);
    for (int beam = 0; beam < 1081; beam += 5) {
      ++all;
      const float range = ranges[static_cast<std::size_t>(beam)];
      if (std::isnan(range)) {
        ++lost;
        continue;
      }
      const double expected = ExpectedRange(world, scan, beam);
      if (std::abs(expected - 10.0) < 0.01) continue;
      Sums& sums = expected < 10.0 ? near : far;
      const double error = static_cast<double>(range) - expected;
      sums.n += 1;
      sums.sum += error;
      sums.squares += error * error;
    }
  }
  ASSERT_GT(near.n, 5000);
  ASSERT_GT(far.n, 5000);
  EXPECT_NEAR(std::sqrt(near.squares / near.n), 0.010, 5 * 0.010 / std::sqrt(2 * near.n));
  EXPECT_NEAR(std::sqrt(far.squares / far.n), 0.017, 5 * 0.017 / std::sqrt(2 * far.n));
  EXPECT_NEAR(near.sum / near.n, 0.0, 5 * 0.010 / std::sqrt(near.n));
  EXPECT_NEAR(far.sum / far.n, 0.0, 5 * 0.017 / std::sqrt(far.n));
  EXPECT_NEAR(lost / all, 0.02, 5 * std::sqrt(0.02 / all));
}

TEST(SimulatedLidar, GlassAnswersWithItsProbabilityAndBeyondReachIsNoReturn) {
  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.glass.push_back({.line = {{8.0, 0.0}, {8.0, 16.0}}, .response = 0.25});
  scenario.blocks.front().waypoints = {{{4.0, 6.0}, ""}, {{4.0, 10.0}, ""}};
  scenario.lidar.range_max_m = 12.0;
  const World world(scenario);
  const SimulatedLidar lidar = world.Lidar();
  // Standing at (4, 6), facing north: beams -110..-70 degrees look east through the pane, at walls 20 m away.
  const ScanGeometry geometry = GeometryOf(scenario.lidar);
  double glass = 0;
  double beyond = 0;
  for (std::int64_t scan = 0; scan < 40; ++scan) {
    const std::vector<float> ranges = lidar.Ranges(scan);
    for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
      const double angle = geometry.angle_min_rad + static_cast<double>(beam) * geometry.angle_increment_rad;
      if (std::abs(angle + std::numbers::pi / 2) > 0.35) continue;
      if (ranges[beam] == kNoReturn) {
        ++beyond;
      } else {
        EXPECT_NEAR(static_cast<double>(ranges[beam]), 4.0 / std::cos(angle + std::numbers::pi / 2), 0.002);
        ++glass;
      }
    }
  }
  ASSERT_GT(glass + beyond, 5000);
  EXPECT_NEAR(glass / (glass + beyond), 0.25, 5 * std::sqrt(0.25 * 0.75 / (glass + beyond)));
}

TEST(SimulatedLidar, PeopleWalkToAndFroAndBlockTheView) {
  const Person person{.path = {{10.0, 5.0}, {14.0, 5.0}, {14.0, 8.0}}, .speed_m_s = 1.0};
  EXPECT_LT((WalkAt(person, 0.0, 3.0).position - Vector2d(13.0, 5.0)).norm(), 1e-9);
  EXPECT_LT((WalkAt(person, 2.0, 3.0).position - Vector2d(14.0, 6.0)).norm(), 1e-9);
  EXPECT_LT((WalkAt(person, 0.0, 9.0).position - Vector2d(14.0, 6.0)).norm(), 1e-9);
  EXPECT_LT((WalkAt(person, 0.0, 9.0).velocity - Vector2d(0.0, -1.0)).norm(), 1e-9);
  EXPECT_LT((WalkAt(person, 0.0, 14.0).position - Vector2d(10.0, 5.0)).norm(), 1e-9);

  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.people.push_back({.path = {{7.0, 3.0}, {7.0, 5.0}}, .speed_m_s = 1.0, .radius_m = 0.25});
  const World world(scenario);
  const SimulatedLidar lidar = world.Lidar();
  // From (4, 4) the beam ahead meets the person, who passes within two seconds, or the wall at 24 m.
  bool seen = false;
  bool past = false;
  for (std::int64_t scan = 0; scan < 80; ++scan) {
    const double ahead = static_cast<double>(lidar.Ranges(scan)[540]);
    if (ahead < 19.0) {
      EXPECT_GE(ahead, 2.749);
      EXPECT_LE(ahead, 3.001);
      seen = true;
    } else {
      EXPECT_NEAR(ahead, 20.0, 0.001);
      past = true;
    }
  }
  EXPECT_TRUE(seen);
  EXPECT_TRUE(past);
}

// Lost echoes are NaN, which equals nothing.
std::vector<float> WithoutLost(std::vector<float> ranges) {
  std::replace_if(
      ranges.begin(), ranges.end(), [](float range) { return std::isnan(range); }, -1.0F);
  return ranges;
}

// Any scan alone, in any order, and with other blocks in the scenario or not.
TEST(SimulatedLidar, ScansDependOnNothingElse) {
  const World world(test_support::RoomScenario());
  Scenario more = test_support::RoomScenario();
  more.blocks.insert(more.blocks.end(), more.blocks.front());
  more.blocks.back().name = "B2";
  const World other(more);
  const SimulatedLidar a = world.Lidar();
  const SimulatedLidar b = other.Lidar();
  const std::vector<float> late = WithoutLost(a.Ranges(700));
  EXPECT_EQ(late, WithoutLost(b.Ranges(700)));
  EXPECT_EQ(late, WithoutLost(a.Ranges(700)));
  const SimulatedLidar second_block(more, more.blocks.back(), other.building, other.Motion());
  EXPECT_NE(late, WithoutLost(second_block.Ranges(700)));
}

// A second method: integrating what an errorless IMU reads gives the exact motion back.
TEST(SimulatedImu, IntegratesBackToTheTrajectory) {
  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.cart.floor_tilt_rad = 0.005;
  scenario.cart.body_from_lidar = {0.4, 0.1, 0.2};
  const World world(scenario);
  const Trajectory& motion = world.Motion();
  const std::vector<ImuSample> imu = SimulateImu(scenario, world.Block(), motion);
  ASSERT_NEAR(static_cast<double>(imu.size()), 200.0 * (motion.end_s() - 100.0), 2.0);

  const double latitude = scenario.imu.latitude_rad;
  const double g = GeographicLib::NormalGravity::WGS84().SurfaceGravity(latitude * 180 / std::numbers::pi);
  const Vector3d earth = GeographicLib::Constants::WGS84_omega() * Vector3d(0, std::cos(latitude), std::sin(latitude));
  Eigen::Isometry3d start = motion.PlanFromBody(100.0);
  Eigen::Matrix3d attitude = start.linear();
  Vector3d position = start.translation();
  Vector3d velocity = motion.BodyVelocity(100.0);
  const auto acceleration = [&](const Eigen::Matrix3d& plan_from_body, const ImuSample& sample, const Vector3d& v) {
    return Vector3d(plan_from_body * sample.specific_force_in_body - 2.0 * earth.cross(v) - Vector3d(0, 0, g));
  };
  double worst_position = 0.0;
  double worst_attitude = 0.0;
  for (std::size_t i = 0; i + 1 < imu.size(); ++i) {
    const double dt = Seconds(imu[i + 1].stamp_ns - imu[i].stamp_ns);
    const Vector3d turn = 0.5 * dt * (imu[i].angular_rate_in_body + imu[i + 1].angular_rate_in_body) -
                          dt * (attitude.transpose() * earth);
    Eigen::Matrix3d next = attitude;
    if (turn.norm() > 0) next = attitude * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    const Vector3d a = 0.5 * (acceleration(attitude, imu[i], velocity) + acceleration(next, imu[i + 1], velocity));
    position += dt * velocity + 0.5 * dt * dt * a;
    velocity += dt * a;
    attitude = next;
    const Eigen::Isometry3d truth = motion.PlanFromBody(Seconds(imu[i + 1].stamp_ns));
    worst_position = std::max(worst_position, (truth.translation() - position).norm());
    worst_attitude = std::max(worst_attitude, Eigen::AngleAxisd(truth.linear().transpose() * attitude).angle());
  }
  EXPECT_LT(worst_attitude, 5e-5);
  EXPECT_LT(worst_position, 0.05);  // after a minute, errors of the integration grow with the square of time
}

TEST(SimulatedImu, BiasesAndNoiseAreAsSpecified) {
  Scenario clean = test_support::PerfectRoomScenario();
  clean.blocks.front().waypoints = {{{4.0, 4.0}, ""}, {{6.0, 4.0}, ""}};
  Scenario noisy = clean;
  const ImuSpec spec;
  noisy.imu = spec;
  double gyro_bias2 = 0;
  double force_bias2 = 0;
  double gyro_noise2 = 0;
  double force_noise2 = 0;
  double samples = 0;
  constexpr int kBlocks = 120;
  for (int block = 0; block < kBlocks; ++block) {
    clean.blocks.front().name = noisy.blocks.front().name = "B" + std::to_string(block);
    const World world(clean);
    const auto truth = SimulateImu(clean, world.Block(), world.Motion());
    const auto read = SimulateImu(noisy, noisy.blocks.front(), world.Motion());
    ASSERT_EQ(truth.size(), read.size());
    Vector3d gyro_mean = Vector3d::Zero();
    Vector3d force_mean = Vector3d::Zero();
    const auto n = static_cast<double>(truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      gyro_mean += (read[i].angular_rate_in_body - truth[i].angular_rate_in_body) / n;
      force_mean += (read[i].specific_force_in_body - truth[i].specific_force_in_body) / n;
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
      gyro_noise2 += (read[i].angular_rate_in_body - truth[i].angular_rate_in_body - gyro_mean).squaredNorm();
      force_noise2 += (read[i].specific_force_in_body - truth[i].specific_force_in_body - force_mean).squaredNorm();
      samples += 3;
    }
    gyro_bias2 += gyro_mean.squaredNorm();
    force_bias2 += force_mean.squaredNorm();
  }
  const double axes = 3.0 * kBlocks;
  const double root_rate = std::sqrt(spec.rate_hz);
  EXPECT_NEAR(std::sqrt(gyro_bias2 / axes) * 180 / std::numbers::pi * 3600, 200.0, 5 * 200.0 / std::sqrt(2 * axes));
  EXPECT_NEAR(std::sqrt(force_bias2 / axes) * 1e5, 2000.0, 5 * 2000.0 / std::sqrt(2 * axes));
  EXPECT_NEAR(std::sqrt(gyro_noise2 / samples), spec.gyro_noise_rad_s_rthz * root_rate, 2e-4);
  EXPECT_NEAR(std::sqrt(force_noise2 / samples), spec.accelerometer_noise_m_s2_rthz * root_rate, 4e-4);
}

TEST(SimulatedOdometry, WithoutErrorsItIsTheMotion) {
  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.cart.body_from_lidar = {0.3, 0.0, 0.5};
  const World world(scenario);
  const std::vector<OdometrySample> odometry = SimulateOdometry(scenario, world.Block(), world.Motion());
  const Pose2 first = world.Motion().PlanarPlanFromBody(100.0);
  for (const OdometrySample& sample : odometry) {
    const Pose2 truth = Between(first, world.Motion().PlanarPlanFromBody(Seconds(sample.stamp_ns)));
    EXPECT_NEAR(sample.odom_from_body.x, truth.x, 1e-6);
    EXPECT_NEAR(sample.odom_from_body.y, truth.y, 1e-6);
    EXPECT_NEAR(NormalizeAngle(sample.odom_from_body.theta - truth.theta), 0.0, 1e-6);
  }
}

TEST(SimulatedOdometry, ScaleDriftAndSlipsAreAsSpecified) {
  Scenario scenario = test_support::PerfectRoomScenario();
  scenario.blocks.front().waypoints = {{{2.0, 4.0}, ""}, {{22.0, 4.0}, ""}};  // 20 m straight on
  const auto last = [](const Scenario& s) {
    const World world(s);
    return SimulateOdometry(s, world.Block(), world.Motion()).back().odom_from_body;
  };
  Scenario scaled = scenario;
  scaled.odometry.scale_error = 0.02;
  EXPECT_NEAR(last(scaled).x, 20.4, 1e-3);
  Scenario drifting = scenario;
  drifting.odometry.angular_drift_rad_per_m = 0.003;
  EXPECT_NEAR(last(drifting).theta, 0.06, 1e-6);
  Scenario slipping = scenario;
  slipping.odometry.slips_per_m = 0.2;
  slipping.odometry.slip_length_m = 0.5;
  slipping.odometry.slip_loss = 0.4;
  double extra = 0;
  constexpr int kBlocks = 60;
  for (int block = 0; block < kBlocks; ++block) {
    slipping.blocks.front().name = "B" + std::to_string(block);
    extra += last(slipping).x - 20.0;
  }
  // A slip begins every 5 m of the distance without one and then lasts 0.5 m: 1 m in 11 slips.
  EXPECT_NEAR(extra / kBlocks, 20.0 * 0.4 * 0.5 / 5.5, 0.15);
}

TEST(SimulatedOdometry, ATypicalBlockDriftsButStaysUsable) {
  const World world(test_support::RoomScenario());
  const std::vector<OdometrySample> odometry = SimulateOdometry(world.scenario, world.Block(), world.Motion());
  const Pose2 truth =
      Between(world.Motion().PlanarPlanFromBody(100.0), world.Motion().PlanarPlanFromBody(world.Motion().end_s()));
  const double error = (odometry.back().odom_from_body.Translation() - truth.Translation()).norm();
  EXPECT_GT(error, 0.1);
  EXPECT_LT(error, 5.0);
}

}  // namespace
}  // namespace survey
