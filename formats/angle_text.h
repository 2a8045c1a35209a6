// SPDX-License-Identifier: Apache-2.0
//
// Angles as surveyors write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace formats {

inline constexpr double kRadPerGon = 3.14159265358979323846 / 200.0;
inline constexpr double kRadPerDegree = 3.14159265358979323846 / 180.0;

// "123-45-06.7", "-0-00-12", "123-45": degrees, minutes, seconds, to rad. Nothing when it is not one; minutes must be
// below 60, seconds not above (programs that round print 60.00).
std::optional<double> ParseDms(std::string_view text);

// "123.4567" gon, "123-45-06.70" degrees.
std::string GonText(double angle_rad, int decimals);
std::string DmsText(double angle_rad, int decimals_of_seconds);

}  // namespace formats
