// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/scan_turn.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr double kLeastTurn_rad = 0.1;
constexpr double kMostTurn_rad = 0.4;
constexpr StampNs kLongestPair = 1'000'000'000;

// Mean difference of the ranges when beam i of `later` is laid over beam i + shift of `earlier`; large when few
// overlap.
double Misfit(std::span<const float> earlier, std::span<const float> later, int shift) {
  constexpr double kMost_m = 1.0;  // what moved, or is seen from elsewhere
  const int n = static_cast<int>(std::min(earlier.size(), later.size()));
  double sum = 0.0;
  int count = 0;
  for (int i = std::max(0, -shift); i < n && i + shift < n; ++i) {
    const float a = earlier[static_cast<std::size_t>(i + shift)];
    const float b = later[static_cast<std::size_t>(i)];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    sum += std::min(kMost_m, static_cast<double>(std::abs(a - b)));
    ++count;
  }
  return count >= n / 4 && count > 10 ? sum / count : kMost_m;
}

// The better of the shifts within a quarter of the expected one.
double BestMisfit(std::span<const float> earlier, std::span<const float> later, double expected_shift) {
  const double slack = 0.25 * std::abs(expected_shift) + 1.0;
  double best = 1e9;
  for (int shift = static_cast<int>(std::floor(expected_shift - slack)); shift <= expected_shift + slack; ++shift)
    best = std::min(best, Misfit(earlier, later, shift));
  return best;
}

}  // namespace

TurnVotes CompareScanTurns(const Session& session, const HeadingOfTime& heading, int max_pairs) {
  TurnVotes votes;
  std::vector<float> earlier_buffer;
  std::vector<float> later_buffer;
  std::size_t first = 0;
  std::optional<double> start = session.scans.empty() ? std::nullopt : heading(session.scans[0].stamp_ns);
  for (std::size_t i = 1; i < session.scans.size() && votes.with + votes.against < max_pairs; ++i) {
    const Scan& later = session.scans[i];
    const Scan& earlier = session.scans[first];
    const std::optional<double> now = heading(later.stamp_ns);
    const double turn = start && now ? NormalizeAngle(*now - *start) : 0.0;
    const bool fresh = start && now && later.stamp_ns - earlier.stamp_ns <= kLongestPair;
    if (fresh && std::abs(turn) < kLeastTurn_rad) continue;
    if (fresh && std::abs(turn) <= kMostTurn_rad && earlier.geometry == later.geometry) {
      const ScanGeometry& geometry = session.geometries[static_cast<std::size_t>(later.geometry)];
      const double shift = turn / geometry.angle_increment_rad;
      const std::span<const float> earlier_m = RangesOf(session, first, &earlier_buffer);
      const std::span<const float> later_m = RangesOf(session, i, &later_buffer);
      const double with = BestMisfit(earlier_m, later_m, shift);
      const double against = BestMisfit(earlier_m, later_m, -shift);
      if (with < 0.7 * against) ++votes.with;
      if (against < 0.7 * with) ++votes.against;
    }
    first = i;
    start = now;
  }
  return votes;
}

}  // namespace survey
