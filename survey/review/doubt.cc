// SPDX-License-Identifier: Apache-2.0
#include "survey/review/doubt.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace survey {
namespace {

constexpr double kLargest_m = 2.0;
constexpr double kOfBreak_m = 1.0;
constexpr double kSmallestLoop_m = 0.15;  // a loop nearer than this agrees
constexpr double kLoopIsTrue = 0.25;      // share of the loops that were not believed and were right

// What prediction alone gets wrong, m per m of path.
double DriftOf(Prediction prediction) {
  switch (prediction) {
    case Prediction::kInertial:
      return 0.10;
    case Prediction::kConstantVelocity:
      return 0.30;
    default:
      return 0.05;
  }
}

class Finder {
 public:
  explicit Finder(const BlockEvidence& evidence) : evidence_(evidence) {}

  std::vector<Doubt> Run() {
    for (const ReviewRequest& request : evidence_.track.requests) AddOfTrack(request);
    for (const Loop& loop : evidence_.loops.loops) AddLoop(loop);
    for (const SolvedMark& mark : evidence_.solution.marks) AddMark(mark);
    for (const PassConflict& conflict : evidence_.conflicts) AddConflict(conflict);
    for (Doubt& doubt : doubts_) doubt.size_m = std::min(doubt.size_m, kLargest_m);
    std::stable_sort(doubts_.begin(), doubts_.end(),
                     [](const Doubt& a, const Doubt& b) { return a.stretch.first < b.stretch.first; });
    return std::move(doubts_);
  }

 private:
  const std::vector<TrackedScan>& Scans() const { return evidence_.track.scans; }
  const Pose2& Estimate(ScanId scan) const { return evidence_.solution.scans[IndexOf(scan)].site_from_scan; }

  // The scans without a match that a request speaks of: it stands at the first of them or behind the last.
  ScanRange Unmatched(ScanId at) const {
    std::size_t first = IndexOf(at);
    std::size_t last = first;
    if (Scans()[first].matched && first > 0 && !Scans()[first - 1].matched) last = --first;
    while (first > 0 && !Scans()[first - 1].matched) --first;
    while (last + 1 < Scans().size() && !Scans()[last + 1].matched) ++last;
    return {IdOf(first), IdOf(last)};
  }

  // Up to the first scan the prediction stood alone even where that one was matched: scans were missing before it.
  double DriftOver(const ScanRange& stretch) const {
    double drift = 0.0;
    for (std::size_t i = std::max<std::size_t>(IndexOf(stretch.first), 1); i <= IndexOf(stretch.last); ++i) {
      const Pose2 step = Between(Scans()[i - 1].local_from_scan, Scans()[i].local_from_scan);
      if (!Scans()[i].matched || i == IndexOf(stretch.first))
        drift += DriftOf(Scans()[i].prediction) * step.Translation().norm();
    }
    return drift;
  }

  void AddOfTrack(const ReviewRequest& request) {
    Doubt doubt{.cause = request.cause,
                .scan = request.scan,
                .stretch = {request.scan, request.scan},
                .size_m = request.doubt,
                .message = request.message};
    if (request.cause == "break") doubt.size_m = kOfBreak_m;
    if (request.cause.ends_with("_only")) {
      doubt.stretch = Unmatched(request.scan);
      doubt.size_m = DriftOver(doubt.stretch);
    }
    for (const RequestMode& mode : request.modes)
      doubt.modes.push_back({request.cause, InSite(request.scan, mode.local_from_scan), mode.weight});
    doubts_.push_back(std::move(doubt));
  }

  // As the track has the other pose against that of the scan.
  Pose2 InSite(ScanId scan, const Pose2& local_from_other) const {
    return Estimate(scan) * Between(Scans()[IndexOf(scan)].local_from_scan, local_from_other);
  }

  void AddLoop(const Loop& loop) {
    if (loop.accepted) return;
    const SubmapConstraint& constraint = loop.constraint;
    const std::vector<SolvedSubmap>& submaps = evidence_.solution.submaps;
    const Pose2 pose =
        submaps[static_cast<std::size_t>(constraint.submap.value)].site_from_submap * constraint.submap_from_scan;
    const double apart = (pose.Translation() - Estimate(constraint.scan).Translation()).norm();
    if (apart < kSmallestLoop_m) return;
    char text[160];
    std::snprintf(text, sizeof text, "a loop to submap %d, %.2f m off, was not believed: %s", constraint.submap.value,
                  apart, loop.reason.c_str());
    doubts_.push_back({.cause = "loop_rejected",
                       .scan = constraint.scan,
                       .stretch = {constraint.scan, constraint.scan},
                       .size_m = kLoopIsTrue * std::min(apart, kLargest_m),
                       .message = text,
                       .modes = {{"loop_rejected", pose, loop.score}}});
  }

  ScanId ScanFrom(StampNs stamp) const {
    const auto found = std::lower_bound(evidence_.stamps.begin(), evidence_.stamps.end(), stamp);
    return IdOf(static_cast<std::size_t>(std::min(found - evidence_.stamps.begin(), std::ssize(evidence_.stamps) - 1)));
  }

  void AddMark(const SolvedMark& mark) {
    const bool left_out = !mark.left_out.empty();
    const bool beyond = mark.test && mark.test->t > evidence_.solution.control.critical_t;
    if (!left_out && !(mark.used && beyond)) return;
    const double residual = mark.residual.norm();
    char text[120];
    std::snprintf(text, sizeof text, "the mark on point %.40s lies %.3f m from its coordinates", mark.point.c_str(),
                  residual);
    doubts_.push_back({.cause = "control_residual",
                       .scan = mark.scan,
                       .stretch = {ScanFrom(mark.start_ns), ScanFrom(mark.end_ns)},
                       .size_m = residual,
                       .message = left_out ? mark.left_out : text});
  }

  void AddConflict(const PassConflict& conflict) {
    char text[120];
    std::snprintf(text, sizeof text, "of %d wall cells that two passes saw one looked through %.0f %%",
                  conflict.walls.compared, 100.0 * conflict.walls.Share());
    doubts_.push_back({.cause = "contradiction",
                       .scan = IdOf((IndexOf(conflict.first) + IndexOf(conflict.last)) / 2),
                       .stretch = {conflict.first, conflict.last},
                       .size_m = conflict.walls.Share(),
                       .message = text,
                       .against = ScanRange{conflict.other_first, conflict.other_last}});
  }

  const BlockEvidence& evidence_;
  std::vector<Doubt> doubts_;
};

}  // namespace

std::vector<Doubt> FindDoubts(const BlockEvidence& evidence) { return Finder(evidence).Run(); }

}  // namespace survey
