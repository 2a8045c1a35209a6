// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/clock_repair.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace survey {
namespace {

constexpr StampNs kSecond = 1'000'000'000;
constexpr StampNs kMicrosecond = 1000;
constexpr StampNs kTenth = kSecond / 10;
constexpr std::size_t kFewestStamps = 200;
// Costs of a step in time: its square, so that steps come out even; far more when it goes back.
constexpr StampNs kLongestStep = 2 * kSecond;
constexpr std::int64_t kCostOfGoingBack = 100'000'000'000'000;  // us2
constexpr std::size_t kMostReadings = 6;                        // as printed, and with up to five zeros put back

// What a printed stamp can have been.
struct Readings {
  std::array<StampNs, kMostReadings> stamp{};
  std::size_t count = 0;
};

Readings PossibleReadings(StampNs printed) {
  Readings readings;
  const StampNs fraction = printed % kSecond;
  const StampNs whole = printed - fraction;
  readings.stamp[readings.count++] = printed;
  if (fraction < kTenth) return readings;
  StampNs us = fraction / kMicrosecond;
  while (us % 10 == 0 && readings.count < kMostReadings) {
    us /= 10;
    readings.stamp[readings.count++] = whole + us * kMicrosecond;
  }
  return readings;
}

std::int64_t CostOfStep(StampNs from, StampNs to) {
  if (to < from) return kCostOfGoingBack;
  const std::int64_t us = std::min(to - from, kLongestStep) / kMicrosecond;
  return us * us;
}

std::size_t CountGoingBack(const std::vector<StampNs>& stamps) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) count += stamps[i] < stamps[i - 1] ? 1 : 0;
  return count;
}

bool ShowsTheFault(const std::vector<StampNs>& stamps) {
  if (stamps.size() < kFewestStamps) return false;
  std::size_t fine = 0;
  for (const StampNs stamp : stamps) {
    const StampNs fraction = stamp % kSecond;
    if (stamp < 0 || stamp % kMicrosecond != 0 || (fraction != 0 && fraction < kTenth)) return false;
    fine += stamp % (10 * kMicrosecond) != 0 ? 1 : 0;
  }
  return 2 * fine > stamps.size() && CountGoingBack(stamps) > 0;
}

// Shortest path through the possible readings (Viterbi).
std::vector<StampNs> MostOrderly(const std::vector<StampNs>& stamps) {
  struct Column {
    Readings readings;
    std::array<std::int64_t, kMostReadings> cost{};
    std::array<std::uint8_t, kMostReadings> from{};
  };
  std::vector<Column> columns(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    Column& now = columns[i];
    now.readings = PossibleReadings(stamps[i]);
    for (std::size_t k = 0; k < now.readings.count; ++k) {
      std::int64_t best = 0;
      for (std::size_t q = 0; i > 0 && q < columns[i - 1].readings.count; ++q) {
        const Column& before = columns[i - 1];
        const std::int64_t cost = before.cost[q] + CostOfStep(before.readings.stamp[q], now.readings.stamp[k]);
        if (q > 0 && cost >= best) continue;
        best = cost;
        now.from[k] = static_cast<std::uint8_t>(q);
      }
      now.cost[k] = best;
    }
  }

  std::vector<StampNs> repaired(stamps.size());
  const auto& last = columns.back();
  std::size_t k = static_cast<std::size_t>(
      std::min_element(last.cost.begin(), last.cost.begin() + static_cast<std::ptrdiff_t>(last.readings.count)) -
      last.cost.begin());
  for (std::size_t i = stamps.size(); i-- > 0;) {
    repaired[i] = columns[i].readings.stamp[k];
    k = columns[i].from[k];
  }
  return repaired;
}

}  // namespace

std::vector<StampNs> RepairUnpaddedMicroseconds(const std::vector<StampNs>& stamps) {
  if (!ShowsTheFault(stamps)) return {};
  std::vector<StampNs> repaired = MostOrderly(stamps);
  if (10 * CountGoingBack(repaired) > CountGoingBack(stamps)) return {};  // something else is wrong
  for (std::size_t i = 0; i < stamps.size(); ++i) repaired[i] -= stamps[i];
  return repaired;
}

}  // namespace survey
