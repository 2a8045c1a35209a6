// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/loop_consistency.h"

#include <cmath>

namespace survey {
namespace {

constexpr double kNeighbours_m = 25.0;  // loops this close along the track must agree

// Whether two loops place two nodes as the track does, within what it may have drifted between them.
bool Agree(const SubmapConstraint& first, const SubmapConstraint& second, const Pose2& by_track, double way,
           const DriftRates& drift) {
  const Pose2 difference = Between(by_track, Between(first.submap_from_scan, second.submap_from_scan));
  const double variance_m = 0.0025 + std::pow(drift.m_per_m * way, 2) + first.covariance.topLeftCorner<2, 2>().trace() +
                            second.covariance.topLeftCorner<2, 2>().trace();
  const double variance_rad =
      1e-4 + std::pow(drift.rad_per_sqrt_m, 2) * way + first.covariance(2, 2) + second.covariance(2, 2);
  return difference.Translation().squaredNorm() / variance_m + difference.theta * difference.theta / variance_rad <
         kChiSquare3;
}

}  // namespace

void KeepMutuallyConsistent(const std::vector<double>& way, const std::vector<Pose2>& local_from_scan,
                            const DriftRates& drift, std::vector<Loop>* loops) {
  std::vector<int> agree(loops->size(), 0);
  std::vector<int> disagree(loops->size(), 0);
  for (std::size_t a = 0; a < loops->size(); ++a) {
    for (std::size_t b = a + 1; b < loops->size() && way[b] - way[a] <= kNeighbours_m; ++b) {
      const bool same = Agree((*loops)[a].constraint, (*loops)[b].constraint,
                              Between(local_from_scan[a], local_from_scan[b]), way[b] - way[a], drift);
      (same ? agree : disagree)[a] += 1;
      (same ? agree : disagree)[b] += 1;
    }
  }
  for (std::size_t i = 0; i < loops->size(); ++i) {
    if (disagree[i] > agree[i]) {
      (*loops)[i].accepted = false;
      (*loops)[i].reason = "contradicts its neighbours";
    } else if (agree[i] == 0) {
      (*loops)[i].accepted = false;
      (*loops)[i].reason = "no neighbour agrees";
    }
  }
}

}  // namespace survey
