// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/unmatched.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "survey/sensors/odometry_track.h"

namespace survey {
namespace {

constexpr double kLongestConstantVelocity_s = 0.3;
constexpr double kLongestInertial_s = 5.0;
constexpr double kLongestScanGap_s = 2.0;

// Scans [begin, end) without a match.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<Stretch> UnmatchedStretches(const Track& track) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 1; i < track.scans.size(); ++i) {
    if (track.scans[i].matched) continue;
    const std::size_t begin = i;
    while (i < track.scans.size() && !track.scans[i].matched) ++i;
    stretches.push_back({begin, i});
  }
  return stretches;
}

double SecondsBefore(const Session& session, std::size_t scan) {
  return Seconds(session.scans[scan].stamp_ns - session.scans[scan - 1].stamp_ns);
}

double SecondsBy(Prediction source, const Session& session, const Track& track, const Stretch& stretch) {
  double seconds = 0.0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    if (track.scans[i].prediction == source) seconds += SecondsBefore(session, i);
  }
  return seconds;
}

std::string Sentence(const char* format, double value) {
  char text[200];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// The correction at a stamp between two steps; empty where the IMU was not navigating.
std::optional<SmoothedCorrection> CorrectionAt(const std::vector<SmoothedCorrection>& corrections, StampNs stamp_ns) {
  const auto after = std::lower_bound(corrections.begin(), corrections.end(), stamp_ns,
                                      [](const SmoothedCorrection& c, StampNs stamp) { return c.stamp_ns < stamp; });
  if (after == corrections.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return *after;
  if (after == corrections.begin() || !after->continues) return std::nullopt;
  const SmoothedCorrection& before = *(after - 1);
  const double f = Seconds(stamp_ns - before.stamp_ns) / Seconds(after->stamp_ns - before.stamp_ns);
  SmoothedCorrection between = before;
  between.filtered_from_smoothed = Interpolate(before.filtered_from_smoothed, after->filtered_from_smoothed, f);
  between.covariance += f * (after->covariance - before.covariance);
  return between;
}

void MoveConstraints(const Stretch& stretch, Track* track) {
  for (SubmapConstraint& constraint : track->constraints) {
    const auto scan = static_cast<std::size_t>(constraint.scan.value);
    if (scan < stretch.begin || scan >= stretch.end) continue;
    const Submap& submap = track->submaps[static_cast<std::size_t>(constraint.submap.value)];
    constraint.submap_from_scan = Between(submap.local_from_submap, track->scans[scan].local_from_scan);
    constraint.covariance = RotatedCovariance(track->scans[scan].covariance, -submap.local_from_submap.theta);
  }
}

// At both ends, beside the IMU.
bool HasOdometry(const Session& session, const Stretch& stretch) {
  const OdometryTrack odometry(session.odometry, 0.5);
  return odometry.At(session.scans[stretch.begin].stamp_ns) && odometry.At(session.scans[stretch.end - 1].stamp_ns);
}

void AddUnmatched(const Session& session, const Stretch& stretch, Track* track) {
  const double seconds = Seconds(session.scans[stretch.end - 1].stamp_ns - session.scans[stretch.begin - 1].stamp_ns);
  const double blind = SecondsBy(Prediction::kConstantVelocity, session, *track, stretch);
  const bool wheels = HasOdometry(session, stretch);
  const double inertial = wheels ? 0.0 : SecondsBy(Prediction::kInertial, session, *track, stretch);
  std::string cause = "odometry_only";
  if (blind > kLongestConstantVelocity_s || inertial > kLongestInertial_s) {
    cause = "break";
  } else if (blind > 0.0) {
    cause = "constant_velocity_only";
  } else if (inertial > 0.0) {
    cause = "inertial_only";
  }
  track->requests.push_back({track->scans[stretch.begin].scan,
                             cause,
                             seconds,
                             std::to_string(stretch.end - stretch.begin) + " scans without a match in the map" +
                                 Sentence(", %.1f s", seconds),
                             {}});
}

bool DroveOn(const Track& track, std::size_t scan) {
  const Pose2 motion = Between(track.scans[scan - 1].local_from_scan, track.scans[scan].local_from_scan);
  return motion.Translation().norm() > 0.5 || std::abs(motion.theta) > 0.5;
}

// Scans are missing before this one. Bridged while the platform stood, that is nothing to ask about.
void AddGap(const Session& session, std::size_t scan, Track* track) {
  const double gap = SecondsBefore(session, scan);
  const Prediction source = track->scans[scan].prediction;
  const bool by_wheels = source != Prediction::kConstantVelocity && HasOdometry(session, {scan - 1, scan + 1});
  const bool by_imu = !by_wheels && source == Prediction::kInertial;
  const bool is_break = !by_wheels && !(by_imu && gap <= kLongestInertial_s);
  if (!is_break && !DroveOn(*track, scan)) return;
  const char* cause = is_break ? "break" : by_wheels ? "odometry_only" : "inertial_only";
  const char* message = by_wheels ? "no scan for %.1f s, bridged by odometry"
                        : by_imu  ? "no scan for %.1f s, with the IMU alone to go by"
                                  : "no scan for %.1f s, with neither odometry nor IMU to go by";
  track->requests.push_back({track->scans[scan].scan, cause, gap, Sentence(message, gap), {}});
}

ScanId ScanFrom(const Session& session, StampNs stamp_ns) {
  const auto found = std::lower_bound(session.scans.begin(), session.scans.end(), stamp_ns,
                                      [](const Scan& scan, StampNs stamp) { return scan.stamp_ns < stamp; });
  return {static_cast<int>(std::min(found - session.scans.begin(), std::ssize(session.scans) - 1))};
}

// From a stamp on for so many seconds the matches were as good as usual.
bool MatchesAreGood(const Session& session, const Track& track, StampNs from_ns, double seconds) {
  double usual = 0.0;
  double here = 0.0;
  int num_usual = 0;
  int num_here = 0;
  for (const TrackedScan& scan : track.scans) {
    if (!scan.matched) continue;
    const double t = Seconds(session.scans[IndexOf(scan.scan)].stamp_ns - from_ns);
    usual += scan.score;
    ++num_usual;
    if (t < 0.0 || t > seconds) continue;
    here += scan.score;
    ++num_here;
  }
  return num_here > 0 && here / num_here > 0.9 * usual / num_usual;
}

// Once a match may be false; where good ones contradict again and again it is the IMU.
bool ImuIsAtFault(const Session& session, const InertialSummary& inertial, const Track& track) {
  constexpr int kOften = 3;
  const auto good = std::count_if(inertial.doubts.begin(), inertial.doubts.end(), [&](const InertialDoubt& doubt) {
    return doubt.cause == InertialDoubt::Cause::kContradicted &&
           MatchesAreGood(session, track, doubt.stamp_ns, doubt.value);
  });
  return good >= kOften && 2 * good > std::ssize(inertial.doubts);
}

void AddDoubtsOfImu(const Session& session, const InertialSummary& inertial, Track* track) {
  const bool at_fault = ImuIsAtFault(session, inertial, *track);
  for (const InertialDoubt& doubt : inertial.doubts) {
    std::string message;
    if (doubt.cause == InertialDoubt::Cause::kTilted) {
      message = Sentence("the platform was tilted by up to %.0f degrees: lifted or carried",
                         doubt.value * 180.0 / std::numbers::pi);
    } else {
      message = Sentence("the scan matches contradict the IMU for %.1f s: ", doubt.value) +
                (at_fault ? "good matches do so again and again, an axis of the IMU is stuck, clipped or exchanged"
                          : "a false match, or the platform was lifted");
    }
    track->requests.push_back({ScanFrom(session, doubt.stamp_ns), "break", doubt.value, message, {}});
  }
}

}  // namespace

void BridgeUnmatched(const Session& session, const std::vector<SmoothedCorrection>& corrections, Track* track) {
  for (const Stretch& stretch : UnmatchedStretches(*track)) {
    if (stretch.end == track->scans.size()) continue;
    std::vector<SmoothedCorrection> found;
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      const std::optional<SmoothedCorrection> correction = CorrectionAt(corrections, session.scans[i].stamp_ns);
      if (track->scans[i].prediction != Prediction::kInertial || !correction) break;
      found.push_back(*correction);
    }
    if (found.size() != stretch.end - stretch.begin) continue;
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      TrackedScan& scan = track->scans[i];
      scan.local_from_scan = scan.local_from_scan * found[i - stretch.begin].filtered_from_smoothed;
      scan.covariance = found[i - stretch.begin].covariance;
    }
    MoveConstraints(stretch, track);
  }
}

void AddRequests(const Session& session, const InertialSummary& inertial, Track* track) {
  for (const Stretch& stretch : UnmatchedStretches(*track)) AddUnmatched(session, stretch, track);
  for (std::size_t i = 1; i < track->scans.size(); ++i) {
    if (SecondsBefore(session, i) > kLongestScanGap_s) AddGap(session, i, track);
  }
  AddDoubtsOfImu(session, inertial, track);
  std::stable_sort(track->requests.begin(), track->requests.end(),
                   [](const ReviewRequest& a, const ReviewRequest& b) { return a.scan < b.scan; });
}

NavigationSummary SummarizeNavigation(const Session& session, const InertialSummary& inertial, const Track& track) {
  const Stretch all{1, track.scans.size()};
  NavigationSummary summary;
  summary.inertial_s = SecondsBy(Prediction::kInertial, session, track, all);
  summary.odometry_s = SecondsBy(Prediction::kOdometry, session, track, all);
  summary.constant_velocity_s = SecondsBy(Prediction::kConstantVelocity, session, track, all);
  for (std::size_t i = 1; i < track.scans.size(); ++i)
    summary.unmatched_s += track.scans[i].matched ? 0.0 : SecondsBefore(session, i);
  summary.imu_restarts = inertial.restarts;
  summary.gyro_bias = inertial.gyro_bias;
  summary.accelerometer_bias = inertial.accelerometer_bias;
  return summary;
}

std::vector<TrackBreak> BreaksOf(const Track& track) {
  std::vector<TrackBreak> breaks;
  for (const ReviewRequest& request : track.requests) {
    if (request.cause == "break") breaks.push_back({request.scan, request.message});
  }
  return breaks;
}

}  // namespace survey
