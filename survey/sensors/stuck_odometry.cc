// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/stuck_odometry.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace survey {
namespace {

constexpr StampNs kSecond = 1'000'000'000;
constexpr int kLongest_s = 10;
constexpr float kSameRange_m = 0.2F;

// Samples [begin, end) with one pose.
struct Stand {
  std::size_t begin;
  std::size_t end;
};

std::vector<Stand> LongStands(const std::vector<OdometrySample>& odometry) {
  std::vector<Stand> stands;
  for (std::size_t begin = 0; begin < odometry.size();) {
    const Eigen::Vector3d pose = odometry[begin].odom_from_body.Vector();
    std::size_t end = begin + 1;
    while (end < odometry.size() && odometry[end].odom_from_body.Vector() == pose) ++end;
    if (odometry[end - 1].stamp_ns - odometry[begin].stamp_ns >= kLongest_s * kSecond) stands.push_back({begin, end});
    begin = end;
  }
  return stands;
}

// Most beams with a return in both read otherwise.
bool LookDifferent(std::span<const float> a, std::span<const float> b) {
  int compared = 0;
  int different = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    ++compared;
    different += std::abs(a[i] - b[i]) > kSameRange_m ? 1 : 0;
  }
  return 2 * different > compared;
}

// Looks once a second.
bool ScansMove(const Session& session, StampNs from_ns, StampNs to_ns) {
  const auto earlier = [](const Scan& scan, StampNs stamp) { return scan.stamp_ns < stamp; };
  const auto first = std::lower_bound(session.scans.begin(), session.scans.end(), from_ns, earlier);
  StampNs next_ns = from_ns;
  int moved = 0;
  std::vector<float> first_buffer;
  std::vector<float> buffer;
  for (auto scan = first; scan != session.scans.end() && scan->stamp_ns <= to_ns && moved < kLongest_s; ++scan) {
    if (scan->stamp_ns < next_ns || scan->geometry != first->geometry) continue;
    next_ns = scan->stamp_ns + kSecond;
    const auto at = [&](auto it) { return static_cast<std::size_t>(it - session.scans.begin()); };
    moved += LookDifferent(RangesOf(session, at(first), &first_buffer), RangesOf(session, at(scan), &buffer)) ? 1 : 0;
  }
  return moved >= kLongest_s;
}

std::string Told(StampNs from_ns, StampNs to_ns) {
  char text[160];
  std::snprintf(text, sizeof text,
                "odometry: one pose from %.3f to %.3f while the scans move: the wheels stopped to count, left out",
                Seconds(from_ns), Seconds(to_ns));
  return text;
}

}  // namespace

std::vector<std::string> DropStuckOdometry(Session* session) {
  std::vector<OdometrySample>& odometry = session->odometry;
  std::vector<OdometrySample> kept;
  std::vector<std::string> told;
  std::size_t next = 0;
  for (const Stand& stand : LongStands(odometry)) {
    const StampNs from_ns = odometry[stand.begin].stamp_ns;
    const StampNs to_ns = odometry[stand.end - 1].stamp_ns;
    if (!ScansMove(*session, from_ns, to_ns)) continue;
    told.push_back(Told(from_ns, to_ns));
    kept.insert(kept.end(), odometry.begin() + static_cast<std::ptrdiff_t>(next),
                odometry.begin() + static_cast<std::ptrdiff_t>(stand.begin) + 1);
    next = stand.end;
  }
  kept.insert(kept.end(), odometry.begin() + static_cast<std::ptrdiff_t>(next), odometry.end());
  odometry = std::move(kept);
  return told;
}

}  // namespace survey
