// SPDX-License-Identifier: Apache-2.0
//
// Rao-Blackwellized particle filter of one block, [AS] section III, [Grisetti07]. The track of the scan matcher, which
// looks at every scan, tells the motion from update to update; at an update each particle moves by it, matches the scan
// in its own map, is sampled around the match and weighted; where the effective sample size drops, the particles are
// resampled; then each draws the scan in its map. Where a person has given the pose of a scan, the particles are seeded
// around it, [AS] section IV-A. Deterministic: random numbers are functions of seed, scan and
// particle.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "survey/particles/proposal.h"
#include "survey/particles/trajectory_tree.h"
#include "survey/submaps/answer.h"
#include "survey/submaps/tracker.h"

namespace survey {

struct ParticleFilterOptions {
  int particles = 30;
  std::int64_t seed = 1;
  ProposalOptions proposal;
  double update_distance_m = 0.5;  // the filter is updated after this motion ...
  double update_angle_rad = 0.25;  // ... or this turn,
  double poor_score_ratio = 0.75;  // and after a fifth of either where scans fit the map worse than this share of usual
  double resampling_share = 0.5;   // resampled when the effective sample size is below this share of the particles
  int drops_together = 5;          // drops so few updates apart are one request; 0: each is asked, as in [AS]
  // Noise of the motion between updates: where scans were matched, and where they were not.
  double matched_sigma_m_per_rtm = 0.015;
  double matched_sigma_rad_per_rtm = 0.004;
  double unmatched_sigma_m_per_rtm = 0.10;
  double unmatched_sigma_rad_per_rtm = 0.05;
};

// Scans at which the filter is updated, ascending, the first scan being the first; none that the tracker could not
// match; with those of which answers speak.
std::vector<ScanId> ScansForUpdates(const Track& track, const Answers& answers, const ParticleFilterOptions& options);

// `track` of the scan matcher; `tracking` are the options it was made with. `progress` is called with the number of
// updates done. `known`: first updates of an earlier run with the same inputs and the same answers up to there; they
// are drawn again, not computed, and the result is the same, bit for bit.
TrajectoryTree RunParticleFilter(const Session& session, const Track& track, const Answers& answers,
                                 const TrackOptions& tracking, const ParticleFilterOptions& options,
                                 const std::function<void(std::size_t)>& progress = {},
                                 const TrajectoryTree& known = {});

}  // namespace survey
