// SPDX-License-Identifier: Apache-2.0
//
// What is said of the front end: that [CN] eq. (6)-(7) as written follows too, that beams are corrected for the motion
// during their sweep, that the maps it holds do not grow with the way.
#include "survey/submaps/tracker.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "survey/geometry/rigid_fit.h"
#include "survey/stats/philox.h"
#include "tests/support/room.h"

namespace survey {
namespace {

double RmsAfterRigidFit(const Track& track, const std::vector<Pose2>& truth) {
  std::vector<Eigen::Vector2d> tracked, wanted;
  for (const TrackedScan& scan : track.scans) tracked.push_back(scan.local_from_scan.Translation());
  for (const Pose2& pose : truth) wanted.push_back(pose.Translation());
  return FitRigid(tracked, wanted)->rms_m;
}

TEST(Tracker, TheOccupancyMatcherFollows) {
  const std::vector<Pose2> truth = test_support::LapsOfTheRing(1);
  const Session session = test_support::SimulateSession(test_support::Ring(), truth, 10.0, 0.01, 1.03, 0.01);
  TrackOptions options;
  options.map.matcher = Matcher::kOccupancy;
  const Track track = TrackBlock(session, options);
  EXPECT_LT(RmsAfterRigidFit(track, truth), 0.10);  // 3 % of each side and 40 degrees by the wheels alone
  const auto matched = std::count_if(track.scans.begin(), track.scans.end(), [](const auto& s) { return s.matched; });
  EXPECT_GT(matched, static_cast<std::ptrdiff_t>(truth.size()) * 9 / 10);
}

// A platform that turns in place: a second to 224 degrees per second, two at that, a second to rest.
constexpr double kTurnRate_rad_s = 3.9;
double HeadingAt(double t) {
  const auto ramp = [](double s) { return 0.5 * std::clamp(s, 0.0, 1.0) * std::clamp(s, 0.0, 1.0); };
  if (t < 1.0) return kTurnRate_rad_s * ramp(t);
  if (t < 3.0) return kTurnRate_rad_s * (t - 0.5);
  return kTurnRate_rad_s * (3.0 - ramp(4.0 - t));
}

// 10 scans a second, of which the sweep takes a quarter of the time, every beam from where the lidar was by then.
Session FastTurn() {
  Session session;
  session.geometries = {test_support::WideScanner(361)};
  ScanGeometry& geometry = session.geometries.front();
  geometry.time_increment_s = 0.025 / geometry.num_beams;
  const std::vector<test_support::Wall> room = test_support::FurnishedRoom();
  for (int k = 0; k < 50; ++k) {
    Scan scan{.stamp_ns = StampNs{100'000'000} * k};
    for (int i = 0; i < geometry.num_beams; ++i) {
      ScanGeometry beam = geometry;
      beam.angle_min_rad += i * geometry.angle_increment_rad;
      beam.num_beams = 1;
      const Pose2 pose{0.5, 0.3, HeadingAt(0.1 * k + i * geometry.time_increment_s)};
      const auto seed = static_cast<std::uint32_t>(k * geometry.num_beams + i);
      scan.ranges_m.push_back(test_support::SimulateRanges(room, pose, beam, 0.01, seed).front());
    }
    session.scans.push_back(std::move(scan));
  }
  return session;
}

struct LargestError {
  double place_m = 0.0;
  double heading_rad = 0.0;
};

LargestError ErrorInTurn(const Session& session) {
  LargestError largest;
  for (const TrackedScan& scan : TrackBlock(session, {}).scans) {
    const double truth = HeadingAt(0.1 * scan.scan.value);
    largest.place_m = std::max(largest.place_m, scan.local_from_scan.Translation().norm());
    largest.heading_rad = std::max(largest.heading_rad, std::abs(NormalizeAngle(scan.local_from_scan.theta - truth)));
  }
  return largest;
}

TEST(Tracker, BeamsAreCorrectedForTheTurnDuringTheirSweep) {
  Session session = FastTurn();
  const LargestError corrected = ErrorInTurn(session);
  EXPECT_LT(corrected.place_m, 0.025);
  EXPECT_LT(corrected.heading_rad, 0.015);
  session.geometries.front().time_increment_s = 0.0;  // as if all beams left at once
  const LargestError skewed = ErrorInTurn(session);
  EXPECT_GT(skewed.place_m, 0.05);
  EXPECT_GT(skewed.heading_rad, 0.1);
}

// Bytes that the heap holds more than before, the most during the run.
std::size_t PeakOfTrack(const Session& session) {
  const auto held = [] {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = held();
  std::size_t peak = before;
  TrackBlock(session, {}, [&](std::size_t) { peak = std::max(peak, held()); });
  return peak - before;
}

// Without an IMU, whose smoother keeps every step.
TEST(Tracker, MapsInMemoryDoNotGrowWithTheWay) {
  const auto walk = [](int laps) {
    return test_support::SimulateSession(test_support::Ring(), test_support::LapsOfTheRing(laps), 10.0, 0.01, 1.0, 0.0);
  };
  const Session two_laps = walk(2);
  const Session ten_laps = walk(10);
  const std::size_t of_two = PeakOfTrack(two_laps);
  if (of_two == 0) GTEST_SKIP() << "this allocator does not tell what it holds";
  const std::size_t of_ten = PeakOfTrack(ten_laps);
  const std::size_t more_scans = ten_laps.scans.size() - two_laps.scans.size();
  EXPECT_LT(of_ten, of_two + 350 * more_scans);  // poses and constraints, no maps
}

}  // namespace
}  // namespace survey
