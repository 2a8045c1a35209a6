// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/tracker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "survey/matching/coarse_search.h"
#include "survey/sensors/odometry_track.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/marks.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

struct ActiveSubmap {
  SubmapId id;
  Pose2 local_from_submap;
  OccupancyPyramid grid;
};

// A predicted pose with its covariance, both in the local frame.
struct PredictedPose {
  Pose2 local_from_scan;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  Twist2 twist;  // of the lidar during the scan
  Prediction source = Prediction::kStart;
};

// Exponentially weighted mean square of the difference between matched and predicted motion.
class Innovations {
 public:
  void Add(const Pose2& predicted_from_matched) {
    square_m_ += kWeight * (0.5 * predicted_from_matched.Translation().squaredNorm() - square_m_);
    square_rad_ += kWeight * (predicted_from_matched.theta * predicted_from_matched.theta - square_rad_);
  }
  double square_m() const { return square_m_; }
  double square_rad() const { return square_rad_; }

 private:
  static constexpr double kWeight = 0.05;
  double square_m_ = 0.0;
  double square_rad_ = 0.0;
};

class Tracker {
 public:
  Tracker(const Session& session, const TrackOptions& options)
      : session_(session),
        options_(options),
        odometry_(session.odometry, options.max_odometry_gap_s),
        projector_(session.geometries, options.max_range_m, 0.0),
        marked_(ScansThatCarryMarks(session)) {}

  void Process(std::size_t index) {
    const Scan& scan = session_.scans[index];
    const PredictedPose predicted = Predict(scan.stamp_ns);
    projector_.Project(scan, predicted.twist, &points_);
    ThinAlongScan(points_.hits, options_.point_spacing_m, static_cast<std::size_t>(options_.max_points), &thinned_);

    TrackedScan tracked = Match(predicted);
    tracked.scan = ScanId{static_cast<int>(index)};
    tracked.is_node = index == 0 || Moved(tracked.local_from_scan) || marked_[index];
    if (tracked.is_node) Insert(tracked);
    Remember(scan.stamp_ns, tracked, predicted);
    track_.scans.push_back(tracked);
  }

  Track Finish() {
    track_.marks = TrackMarks(session_, track_.scans);
    AddRequests();
    return std::move(track_);
  }

 private:
  PredictedPose Predict(StampNs stamp_ns) const {
    PredictedPose predicted;
    if (track_.scans.empty()) {
      predicted.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal();
      return predicted;
    }
    const double dt = Seconds(stamp_ns - last_stamp_ns_);
    Pose2 motion;
    double extra_m = 0.0;
    double extra_rad = 0.0;
    if (const std::optional<Pose2> wheels =
            odometry_.LidarMotion(last_stamp_ns_, stamp_ns, session_.setup.body_from_lidar)) {
      motion = *wheels;
      predicted.source = Prediction::kOdometry;
    } else {
      const double t = std::min(dt, 1.0);
      motion = {last_twist_.vx * t, last_twist_.vy * t, last_twist_.omega * t};
      extra_m = options_.motion.acceleration_m_s2 * t * t;
      extra_rad = options_.motion.acceleration_rad_s2 * t * t;
      predicted.source = Prediction::kConstantVelocity;
    }
    predicted.local_from_scan = last_pose_ * motion;
    predicted.twist = TwistBetween({}, motion, dt);
    const MotionNoise& noise = options_.motion;
    const double path = motion.Translation().norm();
    const double turn = std::abs(motion.theta);
    const double sigma_m = noise.sigma_m + noise.sigma_m_per_m * path + extra_m;
    const double sigma_rad =
        noise.sigma_rad + noise.sigma_rad_per_rad * turn + noise.sigma_rad_per_m * path + extra_rad;
    const double variance_m = sigma_m * sigma_m + 2.0 * innovations_.square_m();
    const double variance_rad = sigma_rad * sigma_rad + 2.0 * innovations_.square_rad();
    predicted.covariance = Eigen::Vector3d(variance_m, variance_m, variance_rad).asDiagonal();
    return predicted;
  }

  TrackedScan Match(const PredictedPose& predicted) {
    TrackedScan tracked{.local_from_scan = predicted.local_from_scan,
                        .covariance = predicted.covariance,
                        .prediction = predicted.source};
    if (active_.empty() || static_cast<int>(thinned_.size()) < options_.min_points) return tracked;
    const ActiveSubmap& submap = active_.front();
    const Pose2 submap_from_local = Inverse(submap.local_from_submap);
    const Pose2 start = submap_from_local * predicted.local_from_scan;
    MatchResult match = MatchScan(submap.grid, thinned_, start, start, predicted.covariance, options_.match);
    if (!match.usable || match.score < options_.poor_score_ratio * usual_score_)
      match = SearchWider(submap.grid, start, predicted, match);
    if (!match.usable) return tracked;
    tracked.local_from_scan = submap.local_from_submap * match.map_from_scan;
    tracked.covariance = match.covariance;
    tracked.score = static_cast<float>(match.score);
    tracked.matched = true;
    return tracked;
  }

  // The match from the prediction is poor: look around for a better one, and keep whichever explains the scan best.
  MatchResult SearchWider(const OccupancyPyramid& grid, const Pose2& start, const PredictedPose& predicted,
                          const MatchResult& first) const {
    MatchResult best = first;
    const double half_width = std::min(options_.search_half_width_m, 3.0 * std::sqrt(predicted.covariance(0, 0)));
    const double half_angle = std::min(options_.search_half_angle_rad, 3.0 * std::sqrt(predicted.covariance(2, 2)));
    for (const Pose2& mode : CoarseSearch(grid, thinned_, start, half_width, half_angle, {})) {
      const MatchResult match = MatchScan(grid, thinned_, mode, start, predicted.covariance, options_.match);
      if (match.usable && (!best.usable || match.score > best.score)) best = match;
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
    SurfacePoints(points_.hits, options_.grid.cell_size_m, kMaxSurfaceGap_m, &surface_);
    for (ActiveSubmap& submap : active_) {
      const Pose2 submap_from_scan = Between(submap.local_from_submap, node.local_from_scan);
      Eigen::Matrix3d covariance = node.covariance;
      // What the match does not see: cell size, drift of the submap while it was drawn.
      covariance.diagonal() += Eigen::Vector3d(1e-4, 1e-4, 4e-6);
      track_.constraints.push_back({submap.id, node.scan, submap_from_scan, covariance});
      track_.submaps[static_cast<std::size_t>(submap.id.value)].nodes.push_back(node.scan);
      TransformPoints(submap_from_scan, points_.hits, &transformed_);
      TransformPoints(submap_from_scan, surface_, &transformed_surface_);
      submap.grid.Insert(submap_from_scan.Translation().cast<float>(), transformed_, {}, transformed_surface_);
    }
    last_node_pose_ = node.local_from_scan;
  }

  void StartSubmap(const Pose2& local_from_scan) {
    if (active_.size() == 2) active_.erase(active_.begin());
    const SubmapId id{static_cast<int>(track_.submaps.size())};
    const Pose2 local_from_submap{local_from_scan.x, local_from_scan.y, 0.0};
    active_.push_back({id, local_from_submap, OccupancyPyramid(options_.grid)});
    track_.submaps.push_back({id, local_from_submap, {}});
    nodes_since_start_ = 0;
  }

  void Remember(StampNs stamp_ns, const TrackedScan& tracked, const PredictedPose& predicted) {
    const double dt = Seconds(stamp_ns - last_stamp_ns_);
    if (!track_.scans.empty()) {
      if (tracked.matched) innovations_.Add(Between(predicted.local_from_scan, tracked.local_from_scan));
      // Bursts of stamps give absurd velocities: keep the old one over intervals that are too short to tell.
      if (dt > 0.01) last_twist_ = TwistBetween(last_pose_, tracked.local_from_scan, dt);
    }
    if (tracked.matched) usual_score_ += 0.02 * (static_cast<double>(tracked.score) - usual_score_);
    last_pose_ = tracked.local_from_scan;
    last_stamp_ns_ = stamp_ns;
  }

  void AddRequests();

  const Session& session_;
  const TrackOptions& options_;
  OdometryTrack odometry_;
  ScanProjector projector_;
  std::vector<bool> marked_;
  Track track_;
  std::vector<ActiveSubmap> active_;  // at most two, the older first
  Innovations innovations_;
  double usual_score_ = 0.5;
  int nodes_since_start_ = 0;
  Pose2 last_node_pose_;
  Pose2 last_pose_;
  Twist2 last_twist_;
  StampNs last_stamp_ns_ = 0;
  ScanPoints points_;                         // of the scan at hand
  std::vector<Eigen::Vector2f> transformed_;  // its hits in a submap's frame
  std::vector<Eigen::Vector2f> thinned_;
  std::vector<Eigen::Vector2f> surface_;
  std::vector<Eigen::Vector2f> transformed_surface_;
};

// A stretch of scans without a match is a question for a person; without odometry it may hide a break of the map.
void Tracker::AddRequests() {
  for (std::size_t i = 1; i < track_.scans.size(); ++i) {
    if (track_.scans[i].matched) continue;
    const std::size_t begin = i;
    while (i < track_.scans.size() && !track_.scans[i].matched) ++i;
    const double seconds = Seconds(session_.scans[i - 1].stamp_ns - session_.scans[begin - 1].stamp_ns);
    const bool odometry = track_.scans[begin].prediction == Prediction::kOdometry;
    track_.requests.push_back({track_.scans[begin].scan, odometry ? "odometry_only" : "break", seconds,
                               std::to_string(i - begin) + " scans without a match in the map"});
  }
}

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
