// SPDX-License-Identifier: Apache-2.0
#include "formats/angle_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "formats/text_numbers.h"

namespace formats {

std::optional<double> ParseDms(std::string_view text) {
  text = Trimmed(text);
  const bool negative = text.starts_with("-");
  if (negative || text.starts_with("+")) text.remove_prefix(1);
  std::array<double, 3> parts{};
  std::size_t count = 0;
  for (; count < parts.size() && !text.empty(); ++count) {
    const std::size_t dash = std::min(text.find('-'), text.size());
    const std::optional<double> part = ParseNumber(text.substr(0, dash));
    if (!part || *part < 0.0 || (count == 1 && *part >= 60.0) || (count == 2 && *part > 60.0)) return std::nullopt;
    const bool last = dash == text.size();
    if (!last && *part != std::floor(*part)) return std::nullopt;
    parts[count] = *part;
    text.remove_prefix(last ? dash : dash + 1);
  }
  if (!text.empty() || count < 2) return std::nullopt;
  const double degrees = parts[0] + parts[1] / 60.0 + parts[2] / 3600.0;
  return (negative ? -degrees : degrees) * kRadPerDegree;
}

std::string GonText(double angle_rad, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, angle_rad / kRadPerGon);
  return text;
}

std::string DmsText(double angle_rad, int decimals_of_seconds) {
  // Rounded once, so that no 60 appears among minutes and seconds.
  const double unit = std::pow(10.0, decimals_of_seconds);
  const double rounded = std::round(std::abs(angle_rad) / kRadPerDegree * 3600.0 * unit) / unit;
  const double degrees = std::floor(rounded / 3600.0);
  const double minutes = std::floor((rounded - degrees * 3600.0) / 60.0);
  const double seconds = std::max(0.0, rounded - degrees * 3600.0 - minutes * 60.0);
  char text[64];
  std::snprintf(text, sizeof text, "%s%.0f-%02.0f-%0*.*f", angle_rad < 0.0 ? "-" : "", degrees, minutes,
                decimals_of_seconds > 0 ? decimals_of_seconds + 3 : 2, decimals_of_seconds, seconds);
  return text;
}

}  // namespace formats
