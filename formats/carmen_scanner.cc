// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_scanner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formats {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The codes of SICK LMS 2xx telegrams in centimetres: 8183 = beyond the greatest distance, 8186 to 8191 = no valid
// measurement (channel error, too little signal, overflow, dazzled, not valid).
enum class SickCode { kNone, kBeyondRange, kNoMeasurement };

constexpr double kSickRangeMax = 81.83;

SickCode SickCodeOf(float range_m) {
  const double centimetres = std::round(static_cast<double>(range_m) * 100.0);
  if (std::abs(static_cast<double>(range_m) * 100.0 - centimetres) > 0.01) return SickCode::kNone;
  if (centimetres == 8183) return SickCode::kBeyondRange;
  return centimetres > 8183 && centimetres <= 8191 ? SickCode::kNoMeasurement : SickCode::kNone;
}

int Steps(int num_beams) { return num_beams - num_beams % 2; }

bool SpansHundredDegrees(int num_beams) {
  const int steps = Steps(num_beams);
  return steps == 100 || steps == 200 || steps == 400;
}

}  // namespace

bool IsKnownNumberOfBeams(int num_beams) {
  const int steps = Steps(num_beams);
  return SpansHundredDegrees(num_beams) || steps == 180 || steps == 360 || steps == 720;
}

void PlaceBeamsByNumber(survey::ScanGeometry* geometry) {
  const double span = (SpansHundredDegrees(geometry->num_beams) ? 100.0 : 180.0) * kDegree;
  geometry->angle_min_rad = -span / 2;
  geometry->angle_increment_rad = span / Steps(geometry->num_beams);
}

double UnroundedAngle(double angle_rad) {
  const double quarters = std::round(angle_rad / kDegree * 4.0);
  const double nominal = quarters / 4.0 * kDegree;
  return quarters != 0 && std::abs(nominal - angle_rad) < 1e-6 ? nominal : angle_rad;
}

// Scanners and drivers clip: then the largest value comes again and again, with next to nothing just below.
CarmenRangeLimits LimitsFromReadings(const std::vector<const std::vector<float>*>& scans) {
  constexpr float kJustBelow = 0.5F;
  constexpr std::size_t kFewest = 20;
  float largest = 0.0F;
  for (const std::vector<float>* ranges : scans) {
    for (const float range : *ranges) largest = std::max(largest, range);
  }
  if (SickCodeOf(largest) != SickCode::kNone) return {.max_m = kSickRangeMax, .sick_codes = true};
  std::size_t at_limit = 0;
  std::size_t just_below = 0;
  for (const std::vector<float>* ranges : scans) {
    for (const float range : *ranges) {
      at_limit += range == largest ? 1 : 0;
      just_below += range < largest && range > largest - kJustBelow ? 1 : 0;
    }
  }
  // As printed: 50 m, not the float next to it.
  const double limit = std::round(static_cast<double>(largest) * 1e4) / 1e4;
  return {.max_m = limit, .max_means_no_return = at_limit >= kFewest && at_limit > just_below};
}

void ClassifyRanges(const CarmenRangeLimits& limits, std::vector<float>* ranges_m) {
  const auto max_m = static_cast<float>(limits.max_m);
  for (float& range : *ranges_m) {
    const SickCode code = limits.sick_codes ? SickCodeOf(range) : SickCode::kNone;
    if (code == SickCode::kNoMeasurement || range <= 0 || range < limits.min_m) {
      range = survey::kInvalidRange;
    } else if (code == SickCode::kBeyondRange || range > max_m || (range == max_m && limits.max_means_no_return)) {
      range = survey::kNoReturn;
    }
  }
}

}  // namespace formats
