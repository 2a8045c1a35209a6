// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/tracker.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "survey/sensors/scan_points.h"
#include "survey/stats/mahalanobis.h"
#include "survey/submaps/marks.h"
#include "survey/submaps/rendering.h"
#include "survey/submaps/unmatched.h"

namespace survey {
namespace {

constexpr double kWidestSearch_m = 2.0;  // behind a gap of the scans
constexpr double kLostScoreRatio = 0.4;  // of the recent scores: below, any heading is tried
constexpr double kBreakScoreRatio = 0.3;

struct ActiveSubmap {
  SubmapId id;
  Pose2 local_from_submap;
  std::unique_ptr<TrackingMap> map;
};

// The covariance of a prediction, scaled so that the pose is no farther off than is likely.
Eigen::Matrix3d WidenedToHold(const Pose2& pose, const Pose2& predicted, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d offset(pose.x - predicted.x, pose.y - predicted.y,
                               NormalizeAngle(pose.theta - predicted.theta));
  const double squared_sigmas = SquaredMahalanobis(offset, covariance) / 3.0;
  return covariance * std::max(1.0, squared_sigmas);
}

class Tracker {
 public:
  Tracker(const Session& session, const TrackOptions& options)
      : session_(session),
        options_(options),
        predictor_(session, options.motion, options.inertial),
        projector_(session.geometries, options.max_range_m, 0.0),
        marked_(ScansThatCarryMarks(session)) {}

  void Process(std::size_t index) {
    const Scan& scan = session_.scans[index];
    const PredictedPose predicted = predictor_.Predict(scan.stamp_ns);
    projector_.Project(session_, index, predicted.twist, &points_, predicted.level_from_lidar);
    prepared_.hits.swap(points_.hits);
    PrepareScan(options_.map, &prepared_);

    TrackedScan tracked = Match(predicted);
    tracked.scan = ScanId{static_cast<int>(index)};
    tracked.is_node = index == 0 || Moved(tracked.local_from_scan) || marked_[index];
    if (tracked.is_node) Insert(tracked);
    if (tracked.matched) WatchScore(tracked);
    predictor_.Update(scan.stamp_ns, tracked.local_from_scan, tracked.covariance, tracked.matched);
    track_.scans.push_back(tracked);
  }

  Track Finish() {
    InertialSummary inertial;
    BridgeUnmatched(session_, predictor_.navigator().Smoothed(&inertial), &track_);
    track_.marks = TrackMarks(session_, track_.scans);
    AddRequests(session_, inertial, &track_);
    track_.navigation = SummarizeNavigation(session_, inertial, track_);
    track_.odometry_lead_s = predictor_.odometry_lead_s();
    return std::move(track_);
  }

 private:
  TrackedScan Match(const PredictedPose& predicted) {
    TrackedScan tracked{.local_from_scan = predicted.local_from_scan,
                        .covariance = predicted.covariance,
                        .prediction = predicted.source};
    if (active_.empty() || static_cast<int>(prepared_.num_points) < options_.min_points) return tracked;
    const ActiveSubmap& submap = active_.front();
    const Pose2 submap_from_local = Inverse(submap.local_from_submap);
    const Pose2 start = submap_from_local * predicted.local_from_scan;
    const MatchResult match = MatchOrSearch(*submap.map, start, predicted);
    if (!match.usable) return tracked;
    tracked.local_from_scan = submap.local_from_submap * match.map_from_scan;
    tracked.covariance = match.covariance;
    tracked.score = static_cast<float>(match.score);
    tracked.matched = true;
    return tracked;
  }

  // A scan that hardly fits its map is drawn into it all the same: what follows keeps to it. Behind a stretch without a
  // match there is a request already.
  void WatchScore(const TrackedScan& tracked) {
    const double share = static_cast<double>(tracked.score) / usual_score_;
    const auto recent = track_.scans.end() - std::min<std::ptrdiff_t>(5, std::ssize(track_.scans));
    const bool asked = std::any_of(recent, track_.scans.end(), [](const TrackedScan& scan) { return !scan.matched; });
    if (share < kBreakScoreRatio && !asked) {
      track_.requests.push_back({tracked.scan,
                                 "break",
                                 1.0 - share,
                                 "the scan fits the map with " + std::to_string(std::lround(100.0 * share)) +
                                     " % of what is usual: its pose may be wrong",
                                 {}});
    }
    usual_score_ += 0.02 * (static_cast<double>(tracked.score) - usual_score_);
  }

  bool Below(double share_of_usual, const MatchResult& match) const {
    return !match.usable || match.score < share_of_usual * usual_score_;
  }

  // From the prediction; where that explains the scan badly, around it as far as it is uncertain; and where that is of
  // no help either, farther, because then the prediction is wrong by more than it says.
  MatchResult MatchOrSearch(const TrackingMap& map, const Pose2& start, const PredictedPose& predicted) const {
    MatchResult match = map.Match(prepared_, start, start, predicted.covariance, Start::kPredicted);
    if (!Below(options_.doubtful_score_ratio, match)) return match;
    const Window likely = {3.0 * std::sqrt(predicted.covariance(0, 0)), 3.0 * std::sqrt(predicted.covariance(2, 2))};
    const Window near = {std::min(likely.half_width_m, options_.search_half_width_m),
                         std::min(likely.half_angle_rad, options_.search_half_angle_rad)};
    match = Search(map, start, predicted.covariance, near, match);
    if (!Below(options_.poor_score_ratio, match)) return match;
    const Window far = {std::clamp(likely.half_width_m, options_.search_half_width_m, kWidestSearch_m),
                        std::clamp(likely.half_angle_rad, 2.0 * options_.search_half_angle_rad, std::numbers::pi),
                        Start::kPredicted};
    match = Search(map, start, predicted.covariance, far, match);
    if (!Below(kLostScoreRatio, match)) return match;
    const Window any_heading = {options_.search_half_width_m, std::numbers::pi, Start::kPredicted};
    const MatchResult turned = Search(map, start, predicted.covariance, any_heading, match);
    return Below(options_.poor_score_ratio, turned) ? match : turned;
  }

  struct Window {
    double half_width_m;
    double half_angle_rad;
    Start start = Start::kNear;  // how far off the poses that the search finds may be
  };

  // The best match in a window around the prediction.
  MatchResult Search(const TrackingMap& map, const Pose2& start, const Eigen::Matrix3d& covariance,
                     const Window& window, const MatchResult& at_hand) const {
    MatchResult best = at_hand;
    for (const Pose2& mode : map.Search(prepared_, start, window.half_width_m, window.half_angle_rad)) {
      const MatchResult match = map.Match(prepared_, mode, start, WidenedToHold(mode, start, covariance), window.start);
      if (match.usable && (!best.usable || match.score > best.score + options_.min_score_gain)) best = match;
    }
    return best;
  }

  bool Moved(const Pose2& local_from_scan) const {
    const Pose2 motion = Between(last_node_pose_, local_from_scan);
    return motion.Translation().norm() > options_.insert_distance_m ||
           std::abs(motion.theta) > options_.insert_angle_rad;
  }

  void Insert(const TrackedScan& node) {
    if (active_.empty() || nodes_since_start_ >= options_.submap_nodes / 2) StartSubmap(node.local_from_scan);
    ++nodes_since_start_;
    for (ActiveSubmap& submap : active_) {
      const Pose2 submap_from_scan = Between(submap.local_from_submap, node.local_from_scan);
      Eigen::Matrix3d covariance = node.covariance;
      // What the match does not see: cell size, drift of the submap while it was drawn.
      covariance.diagonal() += Eigen::Vector3d(1e-4, 1e-4, 4e-6);
      track_.constraints.push_back({submap.id, node.scan, submap_from_scan, covariance});
      track_.submaps[static_cast<std::size_t>(submap.id.value)].nodes.push_back(node.scan);
      submap.map->Insert(submap_from_scan, prepared_);
    }
    last_node_pose_ = node.local_from_scan;
  }

  void StartSubmap(const Pose2& local_from_scan) {
    if (active_.size() == 2) active_.erase(active_.begin());
    const SubmapId id{static_cast<int>(track_.submaps.size())};
    const Pose2 local_from_submap{local_from_scan.x, local_from_scan.y, 0.0};
    active_.push_back({id, local_from_submap, MakeTrackingMap(options_.map)});
    track_.submaps.push_back({id, local_from_submap, {}});
    nodes_since_start_ = 0;
  }

  const Session& session_;
  const TrackOptions& options_;
  MotionPredictor predictor_;
  ScanProjector projector_;
  std::vector<bool> marked_;
  Track track_;
  std::vector<ActiveSubmap> active_;  // at most two, the older first
  double usual_score_ = 0.5;
  int nodes_since_start_ = 0;
  Pose2 last_node_pose_;
  ScanPoints points_;  // of the scan at hand
  PreparedScan prepared_;
};

}  // namespace

Track TrackBlock(const Session& session, const TrackOptions& options,
                 const std::function<void(std::size_t)>& progress) {
  Tracker tracker(session, options);
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    tracker.Process(i);
    if (progress) progress(i + 1);
  }
  return tracker.Finish();
}

}  // namespace survey
