// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/filter_requests.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace survey {
namespace {

constexpr double kGroup_m = 0.5;  // particles of one group lie within this of its first one
constexpr double kGroup_rad = 0.2;
constexpr double kSmallestGroup = 0.15;  // share of the particles
constexpr double kCompared_m = 10.0;
constexpr double kDisagree_m = 0.3;

double SpreadOf(const FilterUpdate& update) { return std::hypot(update.spread.x, update.spread.y); }

// Groups of particles, the largest first.
std::vector<RequestMode> GroupsOf(const FilterUpdate& update) {
  std::vector<RequestMode> groups;
  for (std::size_t i = 0; i < update.poses.size(); ++i) {
    const Pose2& pose = update.poses[i];
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const RequestMode& each) {
      return (each.local_from_scan.Translation() - pose.Translation()).norm() < kGroup_m &&
             std::abs(NormalizeAngle(each.local_from_scan.theta - pose.theta)) < kGroup_rad;
    });
    const double weight = std::exp(update.log_weights[i]);
    if (group == groups.end()) {
      groups.push_back({pose, weight});
    } else {
      group->weight += weight;
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const RequestMode& a, const RequestMode& b) { return a.weight > b.weight; });
  std::erase_if(groups, [](const RequestMode& group) { return group.weight < kSmallestGroup; });
  return groups;
}

class RequestFinder {
 public:
  RequestFinder(const Track& local, const TrajectoryTree& tree, int updates_together, Track* track)
      : local_(local), tree_(tree), updates_together_(static_cast<std::size_t>(updates_together)), track_(*track) {}

  void Run() {
    AddBreaks();
    AddStretches([this](std::size_t k) { return tree_[k].resampled ? SpreadOf(tree_[k]) : -1.0; },
                 [this](std::size_t worst, int count) { return SampleSize(worst, count); });
    AddStretches([this](std::size_t k) { return DoubtOfGroups(k); },
                 [this](std::size_t worst, int) { return Groups(worst); });
    AddStretches([this](std::size_t k) { return Disagreement(k); },
                 [this](std::size_t worst, int) { return Engines(worst); });
    std::stable_sort(track_.requests.begin(), track_.requests.end(),
                     [](const ReviewRequest& a, const ReviewRequest& b) { return a.scan < b.scan; });
  }

 private:
  // One request at the worst update of each row of updates with a doubt that is not negative.
  template <typename DoubtAt, typename RequestAt>
  void AddStretches(const DoubtAt& doubt_at, const RequestAt& request_at) {
    std::size_t last = 0;
    std::size_t worst = 0;
    double largest = 0.0;
    int count = 0;
    const auto close = [&] {
      if (count > 0) track_.requests.push_back(request_at(worst, count));
      count = 0;
    };
    for (std::size_t k = 0; k < tree_.size(); ++k) {
      const double doubt = doubt_at(k);
      if (doubt < 0.0) continue;
      if (count > 0 && k - last > updates_together_) close();
      if (count == 0 || doubt > largest) {
        worst = k;
        largest = doubt;
      }
      last = k;
      ++count;
    }
    close();
  }

  ReviewRequest SampleSize(std::size_t worst, int drops) const {
    const FilterUpdate& update = tree_[worst];
    char text[200];
    std::snprintf(
        text, sizeof text,
        "effective sample size %.1f of %zu, particles spread over %.3f m, %.2f degrees (1 sigma); %d drops in "
        "a row",
        update.effective_size, update.poses.size(), SpreadOf(update), update.spread.theta * 57.29577951308232, drops);
    return {update.scan, "neff", SpreadOf(update), text, {}};
  }

  // Distance between the two largest groups times the share of the smaller one.
  double DoubtOfGroups(std::size_t k) const {
    const std::vector<RequestMode> groups = GroupsOf(tree_[k]);
    if (groups.size() < 2) return -1.0;
    return groups[1].weight *
           (groups[0].local_from_scan.Translation() - groups[1].local_from_scan.Translation()).norm();
  }

  ReviewRequest Groups(std::size_t worst) const {
    std::vector<RequestMode> groups = GroupsOf(tree_[worst]);
    std::string text = "the particles lie in " + std::to_string(groups.size()) + " groups";
    return {tree_[worst].scan, "several_modes", DoubtOfGroups(worst), std::move(text), std::move(groups)};
  }

  const Pose2& Matched(std::size_t k) const { return PoseIn(local_, k); }
  const Pose2& Filtered(std::size_t k) const { return PoseIn(track_, k); }
  const Pose2& PoseIn(const Track& track, std::size_t k) const {
    return track.scans[static_cast<std::size_t>(tree_[k].scan.value)].local_from_scan;
  }

  // The update 10 m of path before another, or the first one.
  std::size_t Before(std::size_t k) const {
    double way = 0.0;
    while (k > 0 && way < kCompared_m) {
      way += Between(Matched(k - 1), Matched(k)).Translation().norm();
      --k;
    }
    return k;
  }

  Pose2 PoseOfMatcher(std::size_t k) const {
    const std::size_t before = Before(k);
    return Filtered(before) * Between(Matched(before), Matched(k));
  }

  double Disagreement(std::size_t k) const {
    const double apart = (PoseOfMatcher(k).Translation() - Filtered(k).Translation()).norm();
    return apart > kDisagree_m ? apart : -1.0;
  }

  ReviewRequest Engines(std::size_t worst) const {
    char text[120];
    std::snprintf(text, sizeof text, "over the last %.0f m particle filter and scan matching come %.2f m apart",
                  kCompared_m, Disagreement(worst));
    return {tree_[worst].scan, "engines_disagree", Disagreement(worst), text, {{PoseOfMatcher(worst), 0.5}}};
  }

  // Scans without a match from update k - 1 to k, when k itself has one.
  int UnmatchedBefore(std::size_t k) const {
    const auto scan = [&](std::size_t update) { return static_cast<std::size_t>(tree_[update].scan.value); };
    if (k == 0 || !track_.scans[scan(k)].matched) return 0;
    int unmatched = 0;
    for (std::size_t i = scan(k - 1) + 1; i < scan(k); ++i) unmatched += track_.scans[i].matched ? 0 : 1;
    return unmatched;
  }

  void AddBreaks() {
    for (std::size_t k = 0; k < tree_.size(); ++k) {
      if (tree_[k].lost)
        track_.requests.push_back(
            {tree_[k].scan, "break", 1.0, "no particle explains the scan; all go on with equal weights", {}});
      if (const int unmatched = UnmatchedBefore(k); unmatched > 0)
        track_.requests.push_back(
            {tree_[k].scan,
             "odometry_only",
             SpreadOf(tree_[k]),
             "the first match behind a stretch without; " + std::to_string(unmatched) + " scans since the last update",
             {}});
    }
  }

  const Track& local_;
  const TrajectoryTree& tree_;
  std::size_t updates_together_;
  Track& track_;
};

}  // namespace

void AddFilterRequests(const Track& local, const TrajectoryTree& tree, int updates_together, Track* track) {
  RequestFinder(local, tree, updates_together, track).Run();
}

}  // namespace survey
