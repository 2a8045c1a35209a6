// SPDX-License-Identifier: Apache-2.0
//
// Faults put into the IMU of a simulated drive are found and named; a sound drive is not blamed.
#include "survey/inertial/imu_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "formats/field_data.h"
#include "survey/simulation/floor_plan.h"
#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "tests/support/real_data.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector3d;

struct Drive {
  std::vector<ImuSample> imu;
  std::vector<OdometrySample> odometry;
};

const Drive& SoundDrive() {
  static const Drive drive = [] {
    const Scenario scenario = test_support::RoomScenario();
    const BlockRoute& block = scenario.blocks.front();
    const RayCaster building(BuildFloorPlan(scenario));
    const RoutePlan plan = PlanRoute(scenario, block, building);
    return Drive{SimulateImu(scenario, block, *plan.trajectory), SimulateOdometry(scenario, block, *plan.trajectory)};
  }();
  return drive;
}

std::vector<ImuSample> Changed(const std::function<void(ImuSample&)>& change) {
  std::vector<ImuSample> imu = SoundDrive().imu;
  for (ImuSample& sample : imu) change(sample);
  return imu;
}

void ExpectFault(const std::vector<ImuSample>& imu, const std::vector<OdometrySample>& odometry,
                 const std::string& words) {
  const std::optional<ImuFault> fault = FindImuFault(imu, odometry);
  ASSERT_TRUE(fault) << words;
  EXPECT_NE(fault->message.find(words), std::string::npos) << fault->message;
}

TEST(ImuChecksTest, ASoundDriveIsNotBlamed) {
  EXPECT_FALSE(FindImuFault(SoundDrive().imu, SoundDrive().odometry));
  EXPECT_TRUE(FindUnusable(SoundDrive().imu).empty());
  EXPECT_TRUE(ImuWarnings(SoundDrive().imu).empty());
  EXPECT_EQ(UsableImu(SoundDrive().imu).size(), SoundDrive().imu.size());
  EXPECT_FALSE(FindImuFault({}, {}));
}

TEST(ImuChecksTest, UnitsAreNamed) {
  ExpectFault(Changed([](ImuSample& s) { s.specific_force_in_body /= 9.80665; }), {}, "which is g: ");
  ExpectFault(Changed([](ImuSample& s) { s.specific_force_in_body *= 1000 / 9.80665; }), {}, "which is mg: ");
  ExpectFault(Changed([](ImuSample& s) { s.specific_force_in_body.z() -= 9.81; }), {}, "gravity was taken out");
  ExpectFault(Changed([](ImuSample& s) { s.specific_force_in_body *= 0.5; }), {}, "which is not gravity");
  const auto degrees = Changed([](ImuSample& s) { s.angular_rate_in_body *= 180.0 / std::numbers::pi; });
  ExpectFault(degrees, {}, "they look like deg/s");
  ExpectFault(degrees, SoundDrive().odometry, "deg/s");
}

TEST(ImuChecksTest, DegreesOfASlowDriveShowAgainstTheOdometry) {
  // Turns too slow to be absurd in degrees.
  std::vector<ImuSample> imu;
  std::vector<OdometrySample> odometry;
  for (int i = 0; i < 200 * 60; ++i) {
    const double t = i * 0.005;
    const double rate = 0.1 * std::sin(0.3 * t);
    imu.push_back({i * 5'000'000LL, {0.01, 0, rate * 57.3}, {0, 0, 9.8}});
    if (i % 4 == 0) odometry.push_back({i * 5'000'000LL, {0, 0, 0.1 / 0.3 * (1 - std::cos(0.3 * t))}});
  }
  ExpectFault(imu, odometry, "times as fast as the odometry");
  EXPECT_FALSE(FindImuFault(imu, {}));
}

TEST(ImuChecksTest, AxesAreNamed) {
  const auto exchange = [](Vector3d& v) { v = Vector3d(v.x(), v.z(), v.y()); };
  ExpectFault(Changed([&](ImuSample& s) {
                exchange(s.specific_force_in_body);
                exchange(s.angular_rate_in_body);
              }),
              SoundDrive().odometry, "gravity shows on y");
  ExpectFault(Changed([](ImuSample& s) {
                s.specific_force_in_body.tail<2>() *= -1;
                s.angular_rate_in_body.tail<2>() *= -1;
              }),
              SoundDrive().odometry, "upside down");
  ExpectFault(Changed([](ImuSample& s) { s.angular_rate_in_body.z() *= -1; }), SoundDrive().odometry,
              "turns against the odometry");
}

TEST(ImuChecksTest, StretchesThatAreNoMeasurementsAreFound) {
  std::vector<ImuSample> imu = SoundDrive().imu;
  for (const std::size_t i : {100U, 101U, 300U}) {
    imu[i].angular_rate_in_body.setZero();
    imu[i].specific_force_in_body.setZero();
  }
  for (std::size_t i = 1000; i < 1100; ++i) {
    imu[i].angular_rate_in_body = imu[1000].angular_rate_in_body;
    imu[i].specific_force_in_body = imu[1000].specific_force_in_body;
  }
  for (std::size_t i = 2000; i < 2050; ++i) imu[i].angular_rate_in_body.z() = i < 2025 ? 2.0 : -2.0;
  const std::vector<UnusableImu> found = FindUnusable(imu);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].end - found[0].begin, 2U);
  EXPECT_EQ(found[2].cause, UnusableImu::Cause::kStuck);
  EXPECT_EQ(found[2].begin, 1000U);
  EXPECT_EQ(found[2].end, 1100U);
  EXPECT_EQ(found[3].cause, UnusableImu::Cause::kSaturated);
  EXPECT_EQ(found[3].axis, "gyro z");
  EXPECT_EQ(found[3].end - found[3].begin, 50U);
  EXPECT_EQ(UsableImu(imu).size(), imu.size() - 153);
  const std::vector<std::string> warnings = ImuWarnings(imu);
  ASSERT_EQ(warnings.size(), 3U);
  EXPECT_NE(warnings[0].find("3 samples in 2 stretches are all zero"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("100 samples in 1 stretches are stuck"), std::string::npos) << warnings[1];
  EXPECT_NE(warnings[2].find("saturated (gyro z at 2)"), std::string::npos) << warnings[2];
  EXPECT_FALSE(FindImuFault(imu, SoundDrive().odometry));
}

TEST(ImuChecksTest, GapsAndTiltAreToldOf) {
  std::vector<ImuSample> imu = SoundDrive().imu;
  imu.erase(imu.begin() + 2000, imu.begin() + 2600);
  ASSERT_EQ(ImuWarnings(imu).size(), 1U);
  EXPECT_EQ(ImuWarnings(imu)[0], "IMU: 1 gaps of more than 0.5 s, the longest of 3.0 s after 109.995");
  const auto tilted = Changed([](ImuSample& s) {
    s.specific_force_in_body = Eigen::AngleAxisd(0.4, Vector3d::UnitX()) * s.specific_force_in_body;
  });
  EXPECT_FALSE(FindImuFault(tilted, {}));
  ASSERT_EQ(ImuWarnings(tilted).size(), 1U);
  EXPECT_NE(ImuWarnings(tilted)[0].find("tilted by 23 degrees"), std::string::npos) << ImuWarnings(tilted)[0];
}

std::vector<ImuSample> ReadBag(const std::string& name, std::vector<OdometrySample>* odometry) {
  const auto file = test_support::RealData(name);
  if (!file) return {};
  formats::FieldData data = formats::ReadFieldData(*file, {});
  *odometry = std::move(data.odometry);
  return std::move(data.imu);
}

TEST(ImuChecksTest, RealRobots) {
  std::vector<OdometrySample> odometry;
  const std::vector<ImuSample> jackal = ReadBag("bags/test2_jackal_imu_odom.bag", &odometry);
  if (jackal.empty()) GTEST_SKIP() << "shared data set bags/ not found";
  const std::optional<ImuFault> fault = FindImuFault(jackal, odometry);
  EXPECT_FALSE(fault) << fault->message;
  EXPECT_TRUE(FindUnusable(jackal).empty());
  // This Husky carries its IMU on edge.
  const std::vector<ImuSample> husky = ReadBag("bags/test1_husky_imu_odom_gps.bag", &odometry);
  ExpectFault(husky, odometry, "gravity shows on y (+9.79 m/s2), the IMU's axes are exchanged");
}

}  // namespace
}  // namespace survey
