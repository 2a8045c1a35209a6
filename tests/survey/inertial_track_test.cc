// SPDX-License-Identifier: Apache-2.0
//
// The front end with its motion sensors taken away one after the other, in a simulated room with known truth, and with
// stretches in which the lidar sees nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "survey/geometry/rigid_fit.h"
#include "survey/simulation/floor_plan.h"
#include "survey/simulation/rig.h"
#include "survey/simulation/route.h"
#include "survey/submaps/tracker.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

struct Drive {
  Session session;
  std::vector<Eigen::Vector2d> truth;  // of the lidar, by scan
};

Drive MakeDrive(Scenario scenario) {
  scenario.lidar.num_beams = 361;
  scenario.lidar.time_increment_s *= 3;
  scenario.lidar.rate_hz = 20;
  const BlockRoute& block = scenario.blocks.front();
  const RayCaster building(BuildFloorPlan(scenario));
  const RoutePlan plan = PlanRoute(scenario, block, building);
  const SimulatedLidar lidar(scenario, block, building, *plan.trajectory);
  Drive made;
  made.session.geometries = {GeometryOf(scenario.lidar)};
  for (std::int64_t k = 0; k < lidar.num_scans(); ++k) {
    const StampNs stamp = lidar.StampOf(k);
    made.session.scans.push_back({.stamp_ns = stamp, .ranges_m = lidar.Ranges(k)});
    made.truth.push_back(plan.trajectory->PlanarPlanFromLidar(Seconds(stamp)).Translation());
  }
  made.session.imu = SimulateImu(scenario, block, *plan.trajectory);
  made.session.odometry = SimulateOdometry(scenario, block, *plan.trajectory);
  return made;
}

const Drive& RoomDrive() {
  static const Drive drive = MakeDrive(test_support::RoomScenario());
  return drive;
}

double Rms(const Track& track, const Drive& drive) {
  std::vector<Eigen::Vector2d> places;
  for (const TrackedScan& scan : track.scans) places.push_back(scan.local_from_scan.Translation());
  return FitRigid(places, drive.truth)->rms_m;
}

double Rms(const Track& track) { return Rms(track, RoomDrive()); }

int Breaks(const Track& track) { return static_cast<int>(BreaksOf(track).size()); }

Session Without(bool imu, bool odometry, Session session = RoomDrive().session) {
  if (!imu) session.imu.clear();
  if (!odometry) session.odometry.clear();
  return session;
}

// The lidar is covered for a while.
void Blind(Session* session, double from_s, double seconds) {
  for (Scan& scan : session->scans) {
    const double t = Seconds(scan.stamp_ns) - from_s;
    if (t >= 0.0 && t < seconds) std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), kNoReturn);
  }
}

TEST(InertialTrackTest, EverySetOfMotionSensorsFollows) {
  struct Case {
    bool imu, odometry;
    Prediction source;
  };
  for (const Case& c : {Case{true, true, Prediction::kInertial}, Case{true, false, Prediction::kInertial},
                        Case{false, true, Prediction::kOdometry}, Case{false, false, Prediction::kConstantVelocity}}) {
    const Track track = TrackBlock(Without(c.imu, c.odometry), {});
    EXPECT_LT(Rms(track), 0.02) << c.imu << c.odometry;
    EXPECT_EQ(track.scans.back().prediction, c.source);
    EXPECT_EQ(Breaks(track), 0) << c.imu << c.odometry;
    const NavigationSummary& by = track.navigation;
    const double whole =
        Seconds(RoomDrive().session.scans.back().stamp_ns - RoomDrive().session.scans.front().stamp_ns);
    EXPECT_NEAR(by.inertial_s + by.odometry_s + by.constant_velocity_s, whole, 1e-6);
    EXPECT_NEAR(by.inertial_s, c.imu ? whole : 0.0, 0.2);
  }
}

TEST(InertialTrackTest, BiasesAreFound) {
  Session session = Without(true, true);
  const Eigen::Vector3d gyro(0.01, -0.02, 0.015);
  for (ImuSample& sample : session.imu) sample.angular_rate_in_body += gyro;
  const Track plain = TrackBlock(Without(true, true), {});
  const Track biased = TrackBlock(session, {});
  EXPECT_LT(Rms(biased), 0.02);
  EXPECT_LT((biased.navigation.gyro_bias - plain.navigation.gyro_bias - gyro).norm(), 5e-4);
}

TEST(InertialTrackTest, AnImuThatDiesHandsOver) {
  Session session = Without(true, false);
  session.imu.resize(session.imu.size() / 2);
  const Track track = TrackBlock(session, {});
  EXPECT_LT(Rms(track), 0.02);
  EXPECT_EQ(track.scans.back().prediction, Prediction::kConstantVelocity);
  EXPECT_GT(track.navigation.inertial_s, 10.0);
  EXPECT_GT(track.navigation.constant_velocity_s, 10.0);
}

TEST(InertialTrackTest, AGapOfTheImuIsBridgedAndCounted) {
  Session session = Without(true, false);
  session.imu.erase(session.imu.begin() + 4000, session.imu.begin() + 4600);  // 3 s
  const Track track = TrackBlock(session, {});
  EXPECT_LT(Rms(track), 0.02);
  EXPECT_EQ(track.navigation.imu_restarts, 1);
  EXPECT_NEAR(track.navigation.constant_velocity_s, 3.1, 0.2);
  EXPECT_EQ(track.scans.back().prediction, Prediction::kInertial);
}

TEST(InertialTrackTest, TheImuCarriesThroughBlindness) {
  Session session = Without(true, false);
  Blind(&session, 115.0, 2.0);
  const Track track = TrackBlock(session, {});
  EXPECT_LT(Rms(track), 0.02);
  EXPECT_EQ(Breaks(track), 0);
  ASSERT_EQ(track.requests.size(), 1U);
  EXPECT_EQ(track.requests[0].cause, "inertial_only");
  EXPECT_NEAR(track.navigation.unmatched_s, 2.0, 0.1);
}

// A stretch is smoothed when 10 s more have been seen, or at the end of the drive: both tell the same of it. One step
// more is not enough.
TEST(InertialTrackTest, ALongDriveIsSmoothedPieceByPiece) {
  Session session = Without(true, false);
  Blind(&session, 95.0, 1.0);
  Blind(&session, 115.0, 3.0);
  const Track whole = TrackBlock(session, {});
  const auto apart = [&](std::size_t look_ahead) {
    TrackOptions options;
    options.inertial.look_ahead = look_ahead;
    const Track pieces = TrackBlock(session, options);
    double farthest = 0.0;
    for (std::size_t i = 0; i < whole.scans.size(); ++i) {
      const Pose2 between = Between(whole.scans[i].local_from_scan, pieces.scans[i].local_from_scan);
      farthest = std::max(farthest, between.Translation().norm());
    }
    return farthest;
  };
  EXPECT_LT(apart(100), 0.001);
  EXPECT_GT(apart(1), 0.005);
}

// Scans are missing while the platform drives on.
Session WithGap(Session session, double from_s, double seconds) {
  std::erase_if(session.scans, [&](const Scan& scan) {
    const double t = Seconds(scan.stamp_ns) - from_s;
    return t > 0.0 && t < seconds;
  });
  return session;
}

// Of the last scan, from the first one on.
double ErrorAtTheEnd(const Track& track) {
  const Eigen::Vector2d way =
      track.scans.back().local_from_scan.Translation() - track.scans.front().local_from_scan.Translation();
  return std::abs(way.norm() - (RoomDrive().truth.back() - RoomDrive().truth.front()).norm());
}

TEST(InertialTrackTest, WheelsCarryOverAGapOfTheScansAndItIsAsked) {
  for (const bool imu : {false, true}) {
    for (const double seconds : {3.0, 8.0, 16.0}) {
      const Track track = TrackBlock(WithGap(Without(imu, true), 116.0, seconds), {});
      EXPECT_LT(ErrorAtTheEnd(track), 0.03) << imu << " " << seconds;
      EXPECT_EQ(Breaks(track), 0) << imu << " " << seconds;
      ASSERT_EQ(track.requests.size(), 1U);
      EXPECT_EQ(track.requests[0].cause, "odometry_only");
      EXPECT_EQ(track.requests[0].message.substr(0, 12), "no scan for ");
    }
  }
}

TEST(InertialTrackTest, AGapOfTheScansThatTheImuBridgesAloneIsABreakWhereItIsLong) {
  const Track bridged = TrackBlock(WithGap(Without(true, false), 116.0, 3.0), {});
  ASSERT_EQ(bridged.requests.size(), 1U);
  EXPECT_EQ(bridged.requests[0].cause, "inertial_only");
  EXPECT_LT(ErrorAtTheEnd(bridged), 0.03);
  EXPECT_EQ(Breaks(TrackBlock(WithGap(Without(true, false), 116.0, 8.0), {})), 1);
}

TEST(InertialTrackTest, BlindnessWithNothingElseIsABreak) {
  Session session = Without(false, false);
  Blind(&session, 115.0, 2.0);
  const Track track = TrackBlock(session, {});
  EXPECT_GE(Breaks(track), 1);
}

TEST(InertialTrackTest, APlatformThatIsCarriedIsABreak) {
  Session session = Without(true, true);
  // Tilted by half a radian and back within 3 s.
  for (ImuSample& sample : session.imu) {
    const double t = Seconds(sample.stamp_ns) - 120.0;
    if (t < 0.0 || t > 3.0) continue;
    const double tilt = 0.25 * (1.0 - std::cos(2.0 * 3.14159265 * t / 3.0));
    const double rate = 0.25 * 2.0 * 3.14159265 / 3.0 * std::sin(2.0 * 3.14159265 * t / 3.0);
    const Eigen::Matrix3d tilted_from_body = Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    sample.specific_force_in_body = tilted_from_body * sample.specific_force_in_body;
    sample.angular_rate_in_body = tilted_from_body * sample.angular_rate_in_body + rate * Eigen::Vector3d::UnitX();
  }
  const Track track = TrackBlock(session, {});
  ASSERT_GE(Breaks(track), 1);
  EXPECT_NE(BreaksOf(track)[0].message.find("the platform was lifted"), std::string::npos)
      << BreaksOf(track)[0].message;
}

TEST(InertialTrackTest, APlatformThatIsPutElsewhereIsABreak) {
  // Eight seconds of the log are lost in all sensors but the clock: the room jumps.
  Session session = Without(true, false);
  const StampNs cut = 118'000'000'000;
  const StampNs skipped = 8'000'000'000;
  std::erase_if(session.scans, [&](const Scan& s) { return s.stamp_ns >= cut && s.stamp_ns < cut + skipped; });
  std::erase_if(session.imu, [&](const ImuSample& s) { return s.stamp_ns >= cut && s.stamp_ns < cut + skipped; });
  for (Scan& scan : session.scans) scan.stamp_ns -= scan.stamp_ns >= cut ? skipped : 0;
  for (ImuSample& sample : session.imu) sample.stamp_ns -= sample.stamp_ns >= cut ? skipped : 0;
  EXPECT_GE(Breaks(TrackBlock(session, {})), 1);
}

TEST(InertialTrackTest, FastTurnsInPlaceAreFollowedByEverySetOfMotionSensors) {
  Scenario scenario = test_support::RoomScenario();
  scenario.cart.turn_rate_rad_s = 3.9;
  scenario.cart.turn_acceleration_rad_s2 = 12.0;
  scenario.blocks.front().waypoints = {{{12.0, 4.0}, "A"}, {{12.0, 7.0}, "B"}, {{12.0, 4.0}, "A"}, {{12.0, 7.0}, "B"}};
  const Drive turns = MakeDrive(scenario);
  double fastest = 0.0;
  for (const ImuSample& sample : turns.session.imu) fastest = std::max(fastest, sample.angular_rate_in_body.norm());
  EXPECT_GT(fastest, 3.5);
  for (const bool imu : {false, true}) {
    for (const bool odometry : {false, true}) {
      const Track track = TrackBlock(Without(imu, odometry, turns.session), {});
      EXPECT_LT(Rms(track, turns), 0.02) << imu << odometry;
      EXPECT_EQ(Breaks(track), 0) << imu << odometry;
    }
  }
}

TEST(InertialTrackTest, AnImuWhoseAxesAreExchangedIsNamed) {
  Session session = Without(true, true);
  for (ImuSample& sample : session.imu) {
    for (Eigen::Vector3d* v : {&sample.angular_rate_in_body, &sample.specific_force_in_body})
      *v = Eigen::Vector3d(v->y(), -v->x(), v->z());
  }
  const Track track = TrackBlock(session, {});
  EXPECT_LT(Rms(track), 0.05);
  ASSERT_GE(Breaks(track), 1);
  EXPECT_NE(BreaksOf(track)[0].message.find("an axis of the IMU is stuck"), std::string::npos)
      << BreaksOf(track)[0].message;
}

}  // namespace
}  // namespace survey
