// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/update_motion.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

double Square(double value) { return value * value; }

bool Rejected(ScanId scan, const Answers& answers) {
  return std::any_of(answers.begin(), answers.end(), [&](const Answer& answer) {
    return answer.decision == Decision::kRejectStretch && answer.scan <= scan && scan <= answer.end;
  });
}

}  // namespace

UpdateMotion MotionBetween(const Track& track, ScanId from, ScanId to, const Answers& answers,
                           const ParticleFilterOptions& options) {
  const auto tracked = [&](int scan) -> const TrackedScan& { return track.scans[static_cast<std::size_t>(scan)]; };
  double variance_m = 1e-6;
  double variance_rad = 1e-7;
  for (int i = from.value + 1; i <= to.value; ++i) {
    const Pose2 step = Between(tracked(i - 1).local_from_scan, tracked(i).local_from_scan);
    const double way = step.Translation().norm() + std::abs(step.theta);
    const bool matched = tracked(i).matched && !Rejected({i}, answers);
    variance_m += way * Square(matched ? options.matched_sigma_m_per_rtm : options.unmatched_sigma_m_per_rtm);
    variance_rad += way * Square(matched ? options.matched_sigma_rad_per_rtm : options.unmatched_sigma_rad_per_rtm);
  }
  return {Between(tracked(from.value).local_from_scan, tracked(to.value).local_from_scan),
          Eigen::Vector3d(variance_m, variance_m, variance_rad).asDiagonal()};
}

}  // namespace survey
