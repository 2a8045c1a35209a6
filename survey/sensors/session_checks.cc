// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/session_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace survey {
namespace {

constexpr StampNs kMarkSlack = 1'000'000'000;

std::string SecondsText(StampNs stamp_ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", Seconds(stamp_ns));
  return text;
}

bool IsFinite(const Pose2& pose) { return pose.Vector().allFinite(); }

bool IsFinite(const ScanGeometry& geometry) {
  return std::isfinite(geometry.angle_min_rad) && std::isfinite(geometry.angle_increment_rad) &&
         std::isfinite(geometry.time_increment_s) && std::isfinite(geometry.range_min_m) &&
         std::isfinite(geometry.range_max_m);
}

class Checks {
 public:
  explicit Checks(const Session& session) : session_(session) {}

  std::vector<SessionFault> Run() {
    if (session_.scans.empty()) {
      Add(SessionPart::kScans, 0,
          "a log without scans: there is nothing to map; scans come from scans.csv, from the laser lines of a CARMEN "
          "log or "
          "from the laser topic of a ROS 1 bag");
      return std::move(faults_);
    }
    CheckScans();
    CheckOrder(SessionPart::kScans, session_.scans);
    CheckOrder(SessionPart::kImu, session_.imu);
    CheckOrder(SessionPart::kOdometry, session_.odometry);
    CheckSameClock(SessionPart::kImu, "IMU", session_.imu);
    CheckSameClock(SessionPart::kOdometry, "odometry", session_.odometry);
    CheckSamples();
    CheckMarks();
    return std::move(faults_);
  }

 private:
  void Add(SessionPart part, std::size_t index, std::string message) {
    faults_.push_back({part, index, std::move(message)});
  }

  void CheckScans() {
    for (std::size_t i = 0; i < session_.scans.size(); ++i) {
      const Scan& scan = session_.scans[i];
      if (scan.geometry < 0 || static_cast<std::size_t>(scan.geometry) >= session_.geometries.size()) {
        Add(SessionPart::kScans, i, "a scan of unknown geometry");
        continue;
      }
      const ScanGeometry& geometry = session_.geometries[static_cast<std::size_t>(scan.geometry)];
      if (!IsFinite(geometry)) Add(SessionPart::kScans, i, "a scan geometry that is not finite");
      if (scan.ranges_m.size() != static_cast<std::size_t>(geometry.num_beams)) {
        Add(SessionPart::kScans, i,
            "wrong beam count: found " + std::to_string(scan.ranges_m.size()) + " ranges, expected " +
                std::to_string(geometry.num_beams));
      }
      const auto negative = [](float range) { return range < 0; };
      if (std::any_of(scan.ranges_m.begin(), scan.ranges_m.end(), negative))
        Add(SessionPart::kScans, i, "a negative range");
    }
  }

  template <typename Sample>
  void CheckOrder(SessionPart part, const std::vector<Sample>& samples) {
    for (std::size_t i = 1; i < samples.size(); ++i) {
      if (samples[i].stamp_ns > samples[i - 1].stamp_ns) continue;
      Add(part, i,
          "time stamp " + SecondsText(samples[i].stamp_ns) + " does not come after " +
              SecondsText(samples[i - 1].stamp_ns));
    }
  }

  template <typename Sample>
  void CheckSameClock(SessionPart part, const std::string& what, const std::vector<Sample>& samples) {
    if (samples.empty()) return;
    const StampNs first = session_.scans.front().stamp_ns;
    const StampNs last = session_.scans.back().stamp_ns;
    if (samples.back().stamp_ns >= first && samples.front().stamp_ns <= last) return;
    Add(part, 0,
        what + " from " + SecondsText(samples.front().stamp_ns) + " to " + SecondsText(samples.back().stamp_ns) +
            " s, scans from " + SecondsText(first) + " to " + SecondsText(last) + " s: not on the same clock");
  }

  void CheckSamples() {
    for (std::size_t i = 0; i < session_.imu.size(); ++i) {
      const ImuSample& sample = session_.imu[i];
      if (!sample.angular_rate_in_body.allFinite() || !sample.specific_force_in_body.allFinite())
        Add(SessionPart::kImu, i, "a value that is not finite");
    }
    for (std::size_t i = 0; i < session_.odometry.size(); ++i) {
      if (!IsFinite(session_.odometry[i].odom_from_body)) Add(SessionPart::kOdometry, i, "a value that is not finite");
    }
  }

  void CheckMarks() {
    for (std::size_t i = 0; i < session_.marks.size(); ++i) CheckMark(i);
    std::vector<std::size_t> order(session_.marks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return session_.marks[a].start_ns < session_.marks[b].start_ns;
    });
    for (std::size_t k = 1; k < order.size(); ++k) {
      const Mark& before = session_.marks[order[k - 1]];
      const Mark& mark = session_.marks[order[k]];
      if (mark.start_ns >= before.end_ns) continue;
      Add(SessionPart::kMarks, order[k],
          "mark on " + mark.point + " from " + SecondsText(mark.start_ns) + " overlaps with the mark on " +
              before.point + " until " + SecondsText(before.end_ns) + ": the platform stands on one point at a time");
    }
  }

  void CheckMark(std::size_t i) {
    const Mark& mark = session_.marks[i];
    const std::string name =
        "mark on " + mark.point + " from " + SecondsText(mark.start_ns) + " to " + SecondsText(mark.end_ns);
    if (mark.start_ns >= mark.end_ns) {
      Add(SessionPart::kMarks, i, name + ": must begin before it ends");
      return;
    }
    const StampNs first = session_.scans.front().stamp_ns;
    const StampNs last = session_.scans.back().stamp_ns;
    if (mark.start_ns < first - kMarkSlack || mark.end_ns > last + kMarkSlack) {
      Add(SessionPart::kMarks, i,
          name + ": lies outside the log, whose scans run from " + SecondsText(first) + " to " + SecondsText(last));
      return;
    }
    const auto scan = std::lower_bound(session_.scans.begin(), session_.scans.end(), mark.start_ns,
                                       [](const Scan& candidate, StampNs stamp) { return candidate.stamp_ns < stamp; });
    if (scan == session_.scans.end() || scan->stamp_ns > mark.end_ns)
      Add(SessionPart::kMarks, i, name + ": holds no scan");
  }

  const Session& session_;
  std::vector<SessionFault> faults_;
};

template <typename Sample>
void WarnOfGaps(const char* what, const std::vector<Sample>& samples, std::vector<std::string>* warnings) {
  constexpr StampNs kLongGap = 5'000'000'000;
  std::size_t gaps = 0;
  StampNs longest = 0;
  StampNs at = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const StampNs gap = samples[i].stamp_ns - samples[i - 1].stamp_ns;
    gaps += gap > kLongGap ? 1 : 0;
    if (gap <= longest) continue;
    longest = gap;
    at = samples[i - 1].stamp_ns;
  }
  if (gaps == 0) return;
  char text[160];
  std::snprintf(text, sizeof text, "%zu gaps of more than %.0f s between %s, the longest of %.1f s after %.3f", gaps,
                Seconds(kLongGap), what, Seconds(longest), Seconds(at));
  warnings->push_back(text);
}

bool IsEmpty(const Scan& scan) {
  return std::none_of(scan.ranges_m.begin(), scan.ranges_m.end(), [](float range) { return std::isfinite(range); });
}

// Scans in which nothing came back: the lidar was covered, or every range is at the maximum.
void WarnOfEmptyScans(const Session& session, std::vector<std::string>* warnings) {
  std::size_t count = 0;
  std::size_t longest_begin = 0;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    const std::size_t begin = i;
    while (i < session.scans.size() && IsEmpty(session.scans[i])) ++i;
    count += i - begin;
    if (i - begin > longest) {
      longest = i - begin;
      longest_begin = begin;
    }
  }
  if (count == 0) return;
  const StampNs first = session.scans[longest_begin].stamp_ns;
  const StampNs last = session.scans[longest_begin + longest - 1].stamp_ns;
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu scans without a single return (all at the maximum, or covered), most in a row from %.3f to %.3f",
                count, Seconds(first), Seconds(last));
  warnings->push_back(text);
}

}  // namespace

std::vector<SessionFault> CheckSession(const Session& session) { return Checks(session).Run(); }

std::vector<std::string> SessionWarnings(const Session& session) {
  std::vector<std::string> warnings;
  WarnOfGaps("scans", session.scans, &warnings);
  WarnOfGaps("odometry samples", session.odometry, &warnings);
  WarnOfEmptyScans(session, &warnings);
  return warnings;
}

}  // namespace survey
