// SPDX-License-Identifier: Apache-2.0
//
// The sense of rotation of scans, gyro and odometry in a simulated room.
#include "survey/inertial/motion_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "survey/sensors/stuck_odometry.h"
#include "survey/simulation/floor_plan.h"
#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

const Session& SoundSession() {
  static const Session session = [] {
    Scenario scenario = test_support::RoomScenario();
    scenario.lidar.num_beams = 361;
    scenario.lidar.rate_hz = 20;
    scenario.lidar.time_increment_s *= 3;
    const BlockRoute& block = scenario.blocks.front();
    const RayCaster building(BuildFloorPlan(scenario));
    const RoutePlan plan = PlanRoute(scenario, block, building);
    const SimulatedLidar lidar(scenario, block, building, *plan.trajectory);
    Session drive;
    drive.geometries = {GeometryOf(scenario.lidar)};
    for (std::int64_t k = 0; k < lidar.num_scans(); ++k)
      drive.scans.push_back({.stamp_ns = lidar.StampOf(k), .ranges_m = lidar.Ranges(k)});
    drive.imu = SimulateImu(scenario, block, *plan.trajectory);
    drive.odometry = SimulateOdometry(scenario, block, *plan.trajectory);
    return drive;
  }();
  return session;
}

Session UpsideDown() {
  Session session = SoundSession();
  for (Scan& scan : session.scans) std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  return session;
}

TEST(MotionChecksTest, ASoundSessionIsNotBlamed) {
  EXPECT_TRUE(CheckSession(SoundSession()).empty());
  EXPECT_TRUE(CheckMotionSensors(SoundSession()).empty());
  EXPECT_TRUE(MotionWarnings(SoundSession()).empty());
  Session session = SoundSession();
  session.imu.clear();
  EXPECT_TRUE(CheckMotionSensors(session).empty());
  session.odometry.clear();
  EXPECT_TRUE(CheckMotionSensors(session).empty());
}

TEST(MotionChecksTest, ALidarUpsideDownIsToldByOdometryOrGyro) {
  Session session = UpsideDown();
  std::vector<SessionFault> faults = CheckMotionSensors(session);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].part, SessionPart::kScans);
  EXPECT_NE(faults[0].message.find("the scans turn against the odometry (in "), std::string::npos);
  session.odometry.clear();
  faults = CheckMotionSensors(session);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_NE(faults[0].message.find("the scans turn against the gyro (in "), std::string::npos);
  EXPECT_NE(faults[0].message.find("the lidar is upside down"), std::string::npos);
}

TEST(MotionChecksTest, TheImuIsToldFirst) {
  Session session = UpsideDown();
  for (ImuSample& sample : session.imu) sample.specific_force_in_body /= 9.80665;
  const std::vector<SessionFault> faults = CheckMotionSensors(session);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].part, SessionPart::kImu);
}

// From 110 s on the wheels tell one pose.
Session WithStuckWheels() {
  Session session = SoundSession();
  std::optional<Pose2> stuck;
  for (OdometrySample& sample : session.odometry) {
    if (sample.stamp_ns < 110'000'000'000) continue;
    if (!stuck) stuck = sample.odom_from_body;
    sample.odom_from_body = *stuck;
  }
  return session;
}

TEST(StuckOdometryTest, WheelsThatStopToCountWhileTheScansMoveAreLeftOut) {
  Session session = WithStuckWheels();
  const std::vector<std::string> told = DropStuckOdometry(&session);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].substr(0, 32), "odometry: one pose from 110.000 ");
  EXPECT_EQ(session.odometry.back().stamp_ns, 110'000'000'000);
  Session sound = SoundSession();
  EXPECT_TRUE(DropStuckOdometry(&sound).empty());
  EXPECT_EQ(sound.odometry.size(), SoundSession().odometry.size());
}

TEST(StuckOdometryTest, APlatformThatStandsStillIsNone) {
  Session session = WithStuckWheels();
  for (Scan& scan : session.scans) scan.ranges_m = session.scans.front().ranges_m;
  EXPECT_TRUE(DropStuckOdometry(&session).empty());
}

}  // namespace
}  // namespace survey
