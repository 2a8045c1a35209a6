// SPDX-License-Identifier: Apache-2.0
//
// Levelling and the search for quiet stretches: analytic attitudes, simulated drives, a real Xsens MT at rest.
#include "survey/inertial/alignment.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "survey/inertial/imu_checks.h"
#include "survey/inertial/strapdown.h"
#include "survey/simulation/floor_plan.h"
#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "tests/support/real_data.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector3d;

TEST(AlignmentTest, LevelsEveryAttitudeAndKeepsTheHeadingAtZero) {
  for (const double pitch : {-1.2, -0.3, 0.0, 0.02, 0.7}) {
    for (const double roll : {-3.0, -0.4, 0.0, 0.1, 1.5}) {
      const Eigen::Quaterniond truth(Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                                     Eigen::AngleAxisd(roll, Vector3d::UnitX()));
      const Eigen::Quaterniond found = LevelFromBody(truth.conjugate() * Vector3d(0, 0, 9.81));
      EXPECT_LT(ToRotationVector(found * truth.conjugate()).norm(), 1e-12) << pitch << " " << roll;
    }
  }
  // Nose up: the heading cannot be read from x; still a rotation that is level.
  const Vector3d force(9.81, 0.0, 0.0);
  EXPECT_LT((LevelFromBody(force) * force - Vector3d(0, 0, 9.81)).norm(), 1e-9);
}

TEST(AlignmentTest, TooLittleIsNoLevelling) {
  EXPECT_FALSE(Level({}));
  const std::array<ImuSample, 3> free_fall{};
  EXPECT_FALSE(Level(free_fall));
}

TEST(AlignmentTest, FindsTheStopsOfASimulatedDrive) {
  const Scenario scenario = test_support::RoomScenario();
  const BlockRoute& block = scenario.blocks.front();
  const RayCaster building(BuildFloorPlan(scenario));
  const RoutePlan plan = PlanRoute(scenario, block, building);
  const Trajectory& motion = *plan.trajectory;
  const std::vector<ImuSample> imu = SimulateImu(scenario, block, motion);
  const std::vector<SampleRange> quiet = FindQuiet(imu, {});
  ASSERT_FALSE(quiet.empty());
  for (const SampleRange& range : quiet) {
    const auto levelling = Level(std::span(imu).subspan(range.begin, range.end - range.begin));
    ASSERT_TRUE(levelling);
    const double time = Seconds(imu[(range.begin + range.end) / 2].stamp_ns);
    EXPECT_LT(std::abs(motion.At(time).first(3)), 0.02) << "turns at " << time;  // yaw rate
    // Levelled to the accelerometers' biases (2000 mGal: 2 mrad) where the cart stands or drives evenly.
    const Vector3d up_in_body = motion.At(time).PlanFromBody().row(2);
    const double error = (levelling->level_from_body * up_in_body - Vector3d::UnitZ()).norm();
    const double accelerates = motion.At(time).second.head<2>().norm();
    EXPECT_LT(error, 0.012 + accelerates / 9.8) << time;
  }
  // The stops on the two points are among them.
  for (const std::string point : {"A", "B"}) {
    bool found = false;
    for (const SampleRange& range : quiet) {
      const double middle = Seconds((imu[range.begin].stamp_ns + imu[range.end - 1].stamp_ns) / 2);
      const Vector3d place = motion.At(middle).Position();
      const Eigen::Vector2d expected = point == "A" ? Eigen::Vector2d(12, 4) : Eigen::Vector2d(18, 8);
      found = found || (place.head<2>() - expected).norm() < 0.05;
    }
    EXPECT_TRUE(found) << point;
  }
}

// Columns: time, specific force (m/s2), angular rate (rad/s), magnetic field.
std::vector<ImuSample> ReadXsens(const std::string& file) {
  std::vector<ImuSample> samples;
  gzFile input = gzopen(file.c_str(), "rb");
  std::array<char, 256> line{};
  while (gzgets(input, line.data(), static_cast<int>(line.size())) != nullptr) {
    std::istringstream text(line.data());
    double time = 0.0;
    ImuSample sample;
    Vector3d& f = sample.specific_force_in_body;
    Vector3d& w = sample.angular_rate_in_body;
    text >> time >> f.x() >> f.y() >> f.z() >> w.x() >> w.y() >> w.z();
    sample.stamp_ns = std::llround(time * 1e9);
    samples.push_back(sample);
  }
  gzclose(input);
  return samples;
}

TEST(AlignmentTest, RealXsensAtRest) {
  for (const char* number : {"000", "001", "002"}) {
    const auto file = test_support::RealData("xsens/MT_cal_00300487_" + std::string(number) + "_cal.log.gz");
    if (!file) GTEST_SKIP() << "shared data set xsens/ not found";
    const std::vector<ImuSample> raw = ReadXsens(file->string());
    ASSERT_GT(raw.size(), 6000U);
    EXPECT_FALSE(FindImuFault(raw, {}));
    EXPECT_FALSE(FindUnusable(raw).empty());  // lost packets: rows of zeros
    const std::vector<ImuSample> imu = UsableImu(raw);
    const std::vector<SampleRange> quiet = FindQuiet(imu, {});
    ASSERT_FALSE(quiet.empty());
    double seconds = 0.0;
    Vector3d low = Vector3d::Constant(1e9);
    Vector3d high = -low;
    for (const SampleRange& range : quiet) {
      constexpr std::size_t kTenSeconds = 2000;
      for (std::size_t begin = range.begin; begin + kTenSeconds <= range.end; begin += kTenSeconds) {
        const auto levelling = Level(std::span(imu).subspan(begin, kTenSeconds));
        ASSERT_TRUE(levelling);
        seconds += levelling->seconds;
        low = low.cwiseMin(levelling->mean_rate_in_body);
        high = high.cwiseMax(levelling->mean_rate_in_body);
        // Normal gravity in Spain is 9.80 m/s2; the unit's own bias is within 2000 mGal.
        EXPECT_NEAR(levelling->mean_force_in_body.norm(), 9.80, 0.02);
        EXPECT_LT(ToRotationVector(levelling->level_from_body).head<2>().norm(), 0.04);
        EXPECT_LT(levelling->rate_sigma.maxCoeff(), 0.015);
      }
    }
    // The mean rate over ten seconds, 1 to 2 deg/s of bias, is the same within a minute to 0.11 deg/s.
    EXPECT_GT(seconds, 25.0);
    EXPECT_GT(low.cwiseAbs().minCoeff(), 0.015);
    EXPECT_LT((high - low).maxCoeff(), 0.002);
    std::printf("%s: %.0f s at rest, bias within %.5f %.5f %.5f rad/s\n", number, seconds, high.x() - low.x(),
                high.y() - low.y(), high.z() - low.z());
  }
}

}  // namespace
}  // namespace survey
