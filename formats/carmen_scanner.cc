// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_scanner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formats {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Telegrams hold centimetres or millimetres: 8183 = beyond the greatest distance, 8186 to 8191 = no valid measurement
// (channel error, too little signal, overflow, dazzled, not valid).
enum class SickCode { kNone, kBeyondRange, kNoMeasurement };

constexpr double kSickRangeMax = 81.83;
constexpr double kSickRangeMaxMillimetre = 8.183;

SickCode SickCodeOf(float range_m, SickUnit unit) {
  if (unit == SickUnit::kNone) return SickCode::kNone;
  const bool millimetres = unit == SickUnit::kMillimetre;
  const double exact = static_cast<double>(range_m) * (millimetres ? 1000.0 : 100.0);
  const double telegram = std::round(exact);
  if (std::abs(exact - telegram) > 0.01 || telegram > 8191) return SickCode::kNone;
  // Millimetres may be printed as centimetres: 8.18 and 8.19.
  if (telegram == 8183 || (millimetres && telegram >= 8180 && telegram < 8185)) return SickCode::kBeyondRange;
  return telegram > 8183 ? SickCode::kNoMeasurement : SickCode::kNone;
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

SickUnit SickUnitOf(double range_max_m) {
  if (range_max_m > 80) return SickUnit::kCentimetre;
  return range_max_m >= 8.0 && range_max_m < 8.2 ? SickUnit::kMillimetre : SickUnit::kNone;
}

// Scanners and drivers clip: then the largest value comes again and again, with next to nothing just below.
CarmenRangeLimits LimitsFromReadings(const std::vector<const std::vector<float>*>& scans) {
  constexpr float kJustBelow = 0.5F;
  constexpr std::size_t kFewest = 20;
  float largest = 0.0F;
  for (const std::vector<float>* ranges : scans) {
    for (const float range : *ranges) largest = std::max(largest, range);
  }
  if (SickCodeOf(largest, SickUnit::kCentimetre) != SickCode::kNone)
    return {.max_m = kSickRangeMax, .sick_codes = SickUnit::kCentimetre};
  // Once is chance at this range.
  const bool may_be_codes = SickCodeOf(largest, SickUnit::kMillimetre) != SickCode::kNone;
  std::size_t codes = 0;
  std::size_t at_limit = 0;
  std::size_t just_below = 0;
  for (const std::vector<float>* ranges : scans) {
    for (const float range : *ranges) {
      codes += may_be_codes && SickCodeOf(range, SickUnit::kMillimetre) != SickCode::kNone ? 1 : 0;
      at_limit += range == largest ? 1 : 0;
      just_below += range < largest && range > largest - kJustBelow ? 1 : 0;
    }
  }
  if (codes >= kFewest && 2 * codes > just_below + at_limit)
    return {.max_m = kSickRangeMaxMillimetre, .sick_codes = SickUnit::kMillimetre};
  // As printed: 50 m, not the float next to it.
  const double limit = std::round(static_cast<double>(largest) * 1e4) / 1e4;
  return {.max_m = limit, .max_means_no_return = at_limit >= kFewest && at_limit > just_below};
}

void ClassifyRanges(const CarmenRangeLimits& limits, std::vector<float>* ranges_m) {
  const auto max_m = static_cast<float>(limits.max_m);
  for (float& range : *ranges_m) {
    const SickCode code = SickCodeOf(range, limits.sick_codes);
    if (code == SickCode::kNoMeasurement || range <= 0 || range < limits.min_m) {
      range = survey::kInvalidRange;
    } else if (code == SickCode::kBeyondRange || range > max_m || (range == max_m && limits.max_means_no_return)) {
      range = survey::kNoReturn;
    }
  }
}

}  // namespace formats
