// SPDX-License-Identifier: Apache-2.0
#include "survey/review/request_list.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr double kDirectionOver_m = 0.5;
constexpr double kBefore_m = 1.0;
constexpr std::size_t kMostModes = 3;
constexpr double kSameMode_m = 0.2;
constexpr double kSameMode_rad = 0.1;

std::vector<double> WayOf(const std::vector<SolvedScan>& scans) {
  std::vector<double> way(scans.size(), 0.0);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    way[i] = way[i - 1] + (scans[i].site_from_scan.Translation() - scans[i - 1].site_from_scan.Translation()).norm();
  }
  return way;
}

bool SameMode(const Pose2& a, const Pose2& b) {
  return (a.Translation() - b.Translation()).norm() < kSameMode_m &&
         std::abs(NormalizeAngle(a.theta - b.theta)) < kSameMode_rad;
}

class RequestMaker {
 public:
  RequestMaker(const Solution& solution, const Answers& answers, const RequestOptions& options)
      : solution_(solution), answers_(answers), options_(options), way_(WayOf(solution.scans)) {}

  std::vector<Request> Run(const std::vector<Doubt>& doubts) {
    std::vector<Request> requests;
    std::vector<const Doubt*> together;
    for (const Doubt& doubt : doubts) {
      if (doubt.size_m < options_.least_doubt_m) continue;
      if (!together.empty() && !Joins(doubt, together)) {
        requests.push_back(RequestOf(together));
        together.clear();
      }
      together.push_back(&doubt);
    }
    if (!together.empty()) requests.push_back(RequestOf(together));
    return requests;
  }

 private:
  const Pose2& Estimate(ScanId scan) const { return solution_.scans[IndexOf(scan)].site_from_scan; }
  double Way(ScanId scan) const { return way_[IndexOf(scan)]; }

  static ScanRange StretchOf(const std::vector<const Doubt*>& doubts) {
    ScanRange stretch = doubts.front()->stretch;
    for (const Doubt* doubt : doubts) stretch.last = std::max(stretch.last, doubt->stretch.last);
    return stretch;
  }

  bool Joins(const Doubt& doubt, const std::vector<const Doubt*>& together) const {
    const ScanRange stretch = StretchOf(together);
    if (!(stretch.last < doubt.stretch.last)) return true;
    return Way(doubt.stretch.first) - Way(stretch.last) <= options_.together_m &&
           Way(doubt.stretch.last) - Way(stretch.first) <= options_.longest_m;
  }

  Request RequestOf(const std::vector<const Doubt*>& doubts) const {
    const Doubt& worst = **std::max_element(doubts.begin(), doubts.end(),
                                            [](const Doubt* a, const Doubt* b) { return a->size_m < b->size_m; });
    Request request{.scan = worst.scan, .stretch = StretchOf(doubts)};
    for (const Doubt* doubt : doubts) AddCause(*doubt, &request);
    std::stable_sort(request.causes.begin(), request.causes.end(),
                     [](const RequestCause& a, const RequestCause& b) { return a.size_m > b.size_m; });
    double squares = 0.0;
    for (const RequestCause& cause : request.causes) squares += cause.size_m * cause.size_m;
    request.score_m = std::sqrt(squares);
    for (const Doubt* doubt : doubts) AddModes(*doubt, &request);
    std::stable_sort(request.modes.begin(), request.modes.end(),
                     [](const PoseMode& a, const PoseMode& b) { return a.weight > b.weight; });
    if (request.modes.size() > kMostModes) request.modes.resize(kMostModes);
    request.spread = SpreadAt(request.scan);
    request.reference = ReferenceOf(request, worst.against);
    request.answer = AnswerOf(request.stretch);
    return request;
  }

  static void AddCause(const Doubt& doubt, Request* request) {
    const auto same = std::find_if(request->causes.begin(), request->causes.end(),
                                   [&](const RequestCause& cause) { return cause.cause == doubt.cause; });
    if (same == request->causes.end()) {
      request->causes.push_back({doubt.cause, doubt.size_m, doubt.message});
    } else if (doubt.size_m > same->size_m) {
      *same = {doubt.cause, doubt.size_m, doubt.message};
    }
  }

  // Carried from the scan of the doubt to the scan that is asked about.
  void AddModes(const Doubt& doubt, Request* request) const {
    const Pose2 motion = Between(Estimate(doubt.scan), Estimate(request->scan));
    for (const PoseMode& mode : doubt.modes) {
      const Pose2 pose = mode.site_from_scan * motion;
      const auto same = std::find_if(request->modes.begin(), request->modes.end(),
                                     [&](const PoseMode& known) { return SameMode(known.site_from_scan, pose); });
      if (same == request->modes.end()) {
        request->modes.push_back({mode.cause, pose, mode.weight});
      } else {
        same->weight = std::max(same->weight, mode.weight);
      }
    }
  }

  // From half a metre before the scan to half a metre behind it; the lidar's heading where the platform did not move.
  double DirectionAt(ScanId scan) const {
    const double here = Way(scan);
    const auto before = std::lower_bound(way_.begin(), way_.end(), here - kDirectionOver_m) - way_.begin();
    const auto behind = std::upper_bound(way_.begin(), way_.end(), here + kDirectionOver_m) - way_.begin() - 1;
    const Eigen::Vector2d moved = solution_.scans[static_cast<std::size_t>(behind)].site_from_scan.Translation() -
                                  solution_.scans[static_cast<std::size_t>(before)].site_from_scan.Translation();
    return moved.norm() > 0.0 ? std::atan2(moved.y(), moved.x()) : Estimate(scan).theta;
  }

  std::optional<PoseSpread> SpreadAt(ScanId scan) const {
    const auto nearest =
        std::min_element(solution_.covariances.begin(), solution_.covariances.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.scan.value - scan.value) < std::abs(b.scan.value - scan.value);
        });
    if (nearest == solution_.covariances.end()) return std::nullopt;
    const Eigen::Matrix3d covariance = RotatedCovariance(nearest->covariance, -DirectionAt(scan));
    const Eigen::Vector3d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    return PoseSpread{sigma.x(), sigma.y(), sigma.z()};
  }

  ScanId NearestOf(const ScanRange& range, ScanId scan) const {
    ScanId nearest = range.first;
    for (ScanId id = range.first; !(range.last < id); ++id.value) {
      if (Apart(id, scan) < Apart(nearest, scan)) nearest = id;
    }
    return nearest;
  }
  double Apart(ScanId a, ScanId b) const { return (Estimate(a).Translation() - Estimate(b).Translation()).norm(); }

  std::optional<RequestReference> ReferenceOf(const Request& request, const std::optional<ScanRange>& against) const {
    if (against) return RequestReference{NearestOf(*against, request.scan), true};
    const auto early =
        std::upper_bound(way_.begin(), way_.end(), Way(request.scan) - options_.earlier_pass_m) - way_.begin();
    if (early > 0) {
      const ScanId nearest = NearestOf({{0}, {static_cast<int>(early) - 1}}, request.scan);
      if (Apart(nearest, request.scan) <= options_.in_view_m) return RequestReference{nearest, true};
    }
    const auto before =
        std::upper_bound(way_.begin(), way_.end(), Way(request.stretch.first) - kBefore_m) - way_.begin();
    if (before == 0) return std::nullopt;
    return RequestReference{IdOf(static_cast<std::size_t>(before) - 1), false};
  }

  std::optional<std::size_t> AnswerOf(const ScanRange& stretch) const {
    for (std::size_t i = 0; i < answers_.size(); ++i) {
      if (!(answers_[i].scan < stretch.first) && !(stretch.last < answers_[i].scan)) return i;
    }
    return std::nullopt;
  }

  const Solution& solution_;
  const Answers& answers_;
  const RequestOptions& options_;
  std::vector<double> way_;  // m along the path, by scan
};

}  // namespace

std::vector<Request> MakeRequests(const std::vector<Doubt>& doubts, const Solution& solution, const Answers& answers,
                                  const RequestOptions& options) {
  return RequestMaker(solution, answers, options).Run(doubts);
}

}  // namespace survey
