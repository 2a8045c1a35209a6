// SPDX-License-Identifier: Apache-2.0
#include "formats/map_greys.h"

#include <algorithm>
#include <cmath>

#include "survey/grid/site_raster.h"

namespace formats {
namespace {

// The thresholds of ROS map_server; its saver's grey for unknown reads back as 0.196078 > kFree.
constexpr float kOccupied = 0.65F;
constexpr float kFree = 0.196F;
constexpr std::uint8_t kUnknownGrey = 205;

}  // namespace

std::uint8_t PictureGrey(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownGrey;
  const float blackness = (survey::ProbabilityFromLogOdds(log_odds) - kFree) / (kOccupied - kFree);
  return static_cast<std::uint8_t>(std::lround(255.0F * (1.0F - std::clamp(blackness, 0.0F, 1.0F))));
}

std::uint8_t RosGrey(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownGrey;
  const float probability = survey::ProbabilityFromLogOdds(log_odds);
  if (probability >= kOccupied) return 0;
  return probability <= kFree ? 254 : kUnknownGrey;
}

}  // namespace formats
