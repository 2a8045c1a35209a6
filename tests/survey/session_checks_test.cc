// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/session_checks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace survey {
namespace {

constexpr StampNs kSecond = 1'000'000'000;

// Ten seconds at 2 Hz from t = 100 s.
Session SoundSession() {
  Session session;
  session.geometries = {{.angle_min_rad = -1, .angle_increment_rad = 1, .range_max_m = 30, .num_beams = 3}};
  for (StampNs i = 0; i <= 20; ++i) {
    session.scans.push_back(
        {.stamp_ns = 100 * kSecond + i * kSecond / 2, .ranges_m = {1.0F, kNoReturn, kInvalidRange}});
    session.odometry.push_back({.stamp_ns = session.scans.back().stamp_ns});
    session.imu.push_back({.stamp_ns = session.scans.back().stamp_ns});
  }
  session.marks = {{"P1", 102 * kSecond, 104 * kSecond}, {"P2", 104 * kSecond, 106 * kSecond}};
  return session;
}

std::string OnlyFault(const Session& session) {
  const std::vector<SessionFault> faults = CheckSession(session);
  EXPECT_EQ(faults.size(), 1U);
  return faults.empty() ? "none" : faults.front().message;
}

TEST(SessionChecksTest, ASoundSessionHasNoFaults) {
  EXPECT_TRUE(CheckSession(SoundSession()).empty());
  EXPECT_TRUE(SessionWarnings(SoundSession()).empty());
}

TEST(SessionChecksTest, MarksMayBeWrittenToTheSecond) {
  Session session = SoundSession();
  session.marks = {{"P1", 99 * kSecond, 101 * kSecond}, {"P2", 109 * kSecond, 111 * kSecond}};
  EXPECT_TRUE(CheckSession(session).empty());
}

TEST(SessionChecksTest, FindsEveryFault) {
  Session session;
  EXPECT_TRUE(OnlyFault(session).starts_with("a log without scans: there is nothing to map"));

  session = SoundSession();
  session.scans[3].ranges_m.pop_back();
  EXPECT_EQ(OnlyFault(session), "wrong beam count: found 2 ranges, expected 3");

  session = SoundSession();
  session.scans[3].geometry = 1;
  EXPECT_EQ(OnlyFault(session), "a scan of unknown geometry");

  session = SoundSession();
  session.scans[3].ranges_m[0] = -1.0F;
  EXPECT_EQ(OnlyFault(session), "a negative range");

  session = SoundSession();
  session.scans[3].stamp_ns = session.scans[2].stamp_ns;
  EXPECT_EQ(OnlyFault(session), "time stamp 101.000000 does not come after 101.000000");

  session = SoundSession();
  session.imu[5].angular_rate_in_body.x() = std::nan("");
  EXPECT_EQ(OnlyFault(session), "a value that is not finite");

  session = SoundSession();
  session.odometry[5].odom_from_body.theta = std::nan("");
  EXPECT_EQ(OnlyFault(session), "a value that is not finite");

  session = SoundSession();
  for (ImuSample& sample : session.imu) sample.stamp_ns -= 50 * kSecond;
  EXPECT_EQ(OnlyFault(session),
            "IMU from 50.000000 to 60.000000 s, scans from 100.000000 to 110.000000 s: not on the same clock");
}

TEST(SessionChecksTest, FindsFaultyMarks) {
  Session session = SoundSession();
  session.marks = {{"P1", 104 * kSecond, 104 * kSecond}};
  EXPECT_EQ(OnlyFault(session), "mark on P1 from 104.000000 to 104.000000: must begin before it ends");

  session.marks = {{"P1", 90 * kSecond, 104 * kSecond}};
  EXPECT_EQ(OnlyFault(session),
            "mark on P1 from 90.000000 to 104.000000: lies outside the log, whose scans run from 100.000000 to "
            "110.000000");

  session.marks = {{"P2", 103 * kSecond, 106 * kSecond}, {"P1", 101 * kSecond, 104 * kSecond}};
  const std::vector<SessionFault> faults = CheckSession(session);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].index, 0U);  // the later one, wherever it stands in the file
  EXPECT_EQ(faults[0].part, SessionPart::kMarks);
  EXPECT_EQ(
      faults[0].message,
      "mark on P2 from 103.000000 overlaps with the mark on P1 until 104.000000: the platform stands on one point "
      "at a time");

  session.marks = {{"P1", 101 * kSecond + 1, 101 * kSecond + 2}};
  EXPECT_EQ(OnlyFault(session), "mark on P1 from 101.000000 to 101.000000: holds no scan");
}

TEST(SessionChecksTest, TellsOfLongGaps) {
  Session session = SoundSession();
  for (std::size_t i = 11; i < session.scans.size(); ++i) session.scans[i].stamp_ns += 20 * kSecond;
  const std::vector<std::string> warnings = SessionWarnings(session);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0], "1 gaps of more than 5 s between scans, the longest of 20.5 s after 105.000");
}

TEST(SessionChecksTest, TellsOfGapsInTheOdometryAndOfEmptyScans) {
  Session session = SoundSession();
  session.odometry.erase(session.odometry.begin() + 5, session.odometry.begin() + 16);
  for (std::size_t i = 8; i < 12; ++i) session.scans[i].ranges_m = {kNoReturn, kNoReturn, kInvalidRange};
  session.scans[2].ranges_m[0] = kNoReturn;
  const std::vector<std::string> warnings = SessionWarnings(session);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "1 gaps of more than 5 s between odometry samples, the longest of 6.0 s after 102.000");
  EXPECT_EQ(warnings[1],
            "5 scans without a single return (all at the maximum, or covered), most in a row from 104.000 to 105.500");
}

}  // namespace
}  // namespace survey
