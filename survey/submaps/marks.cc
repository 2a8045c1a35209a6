// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/marks.h"

#include <algorithm>
#include <cstdlib>

namespace survey {
namespace {

std::size_t FirstScanFrom(const Session& session, StampNs stamp_ns) {
  const auto found = std::lower_bound(session.scans.begin(), session.scans.end(), stamp_ns,
                                      [](const Scan& scan, StampNs stamp) { return scan.stamp_ns < stamp; });
  return static_cast<std::size_t>(found - session.scans.begin());
}

std::size_t CarryingScan(const Session& session, const Mark& mark) {
  const StampNs middle = mark.start_ns + (mark.end_ns - mark.start_ns) / 2;
  const std::size_t after = std::min(FirstScanFrom(session, middle), session.scans.size() - 1);
  if (after == 0) return after;
  const StampNs before_gap = middle - session.scans[after - 1].stamp_ns;
  const StampNs after_gap = std::abs(session.scans[after].stamp_ns - middle);
  return before_gap < after_gap ? after - 1 : after;
}

}  // namespace

std::vector<bool> ScansThatCarryMarks(const Session& session) {
  std::vector<bool> carries(session.scans.size(), false);
  for (const Mark& mark : session.marks) carries[CarryingScan(session, mark)] = true;
  return carries;
}

std::vector<TrackedMark> TrackMarks(const Session& session, const std::vector<TrackedScan>& scans) {
  std::vector<TrackedMark> marks;
  for (const Mark& mark : session.marks) {
    const std::size_t carrier = CarryingScan(session, mark);
    const Pose2 scan_from_local = Inverse(scans[carrier].local_from_scan);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    double count = 0.0;
    for (std::size_t i = FirstScanFrom(session, mark.start_ns);
         i < scans.size() && session.scans[i].stamp_ns <= mark.end_ns; ++i) {
      if (!scans[i].matched && i != carrier) continue;
      const Eigen::Vector2d place = scan_from_local * (scans[i].local_from_scan * session.setup.mark_in_lidar);
      sum += place;
      squares += place * place.transpose();
      count += 1.0;
    }
    TrackedMark tracked{
        .point = mark.point, .start_ns = mark.start_ns, .end_ns = mark.end_ns, .scan = scans[carrier].scan};
    tracked.mark_in_scan = count > 0 ? Eigen::Vector2d(sum / count) : session.setup.mark_in_lidar;
    const double centring = session.setup.mark_sigma_m * session.setup.mark_sigma_m;
    tracked.covariance = centring * Eigen::Matrix2d::Identity();
    if (count > 1.0) {
      const Eigen::Matrix2d scatter = (squares - sum * sum.transpose() / count) / (count - 1.0);
      tracked.covariance += scatter / count;
    }
    marks.push_back(std::move(tracked));
  }
  std::stable_sort(marks.begin(), marks.end(),
                   [](const TrackedMark& a, const TrackedMark& b) { return a.start_ns < b.start_ns; });
  return marks;
}

}  // namespace survey
