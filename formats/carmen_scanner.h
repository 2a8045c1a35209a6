// SPDX-License-Identifier: Apache-2.0
//
// How the laser scanners in CARMEN logs place their beams and what their largest readings mean, where the log does not
// say. The rules are in README.md, "CARMEN logs".
#pragma once

#include <vector>

#include "survey/sensors/session.h"

namespace formats {

// FLASER and RLASER state only the number of readings. The scanners of their time: 180 or 100 degrees in steps of 1,
// 1/2 or 1/4 degree; an odd number of beams has both ends, an even one lacks the last (180: -90 to +89 degrees).
// Other numbers are taken to span 180 degrees.
bool IsKnownNumberOfBeams(int num_beams);
void PlaceBeamsByNumber(survey::ScanGeometry* geometry);  // fills the angles from num_beams

// 0.017453 is one degree, printed short: the nearest quarter of a degree, when that is within the last digit.
double UnroundedAngle(double angle_rad);

// The telegrams of a SICK LMS 2xx hold 8182 at most; from 8183 on they are codes.
enum class SickUnit { kNone, kCentimetre, kMillimetre };

struct CarmenRangeLimits {
  double min_m = 0.0;
  double max_m = 0.0;
  bool max_means_no_return = true;  // a reading of max_m itself; greater ones always do
  SickUnit sick_codes = SickUnit::kNone;
};

// The codes that a scanner of that range writes.
SickUnit SickUnitOf(double range_max_m);

// The limit of a log that does not state it, from all its readings.
CarmenRangeLimits LimitsFromReadings(const std::vector<const std::vector<float>*>& scans);

// Readings as printed become ranges, kNoReturn and kInvalidRange.
void ClassifyRanges(const CarmenRangeLimits& limits, std::vector<float>* ranges_m);

}  // namespace formats
