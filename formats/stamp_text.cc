// SPDX-License-Identifier: Apache-2.0
#include "formats/stamp_text.h"

#include <charconv>
#include <chrono>
#include <regex>

namespace formats {
namespace {

std::optional<survey::StampNs> StampOfUtc(const std::smatch& parts) {
  namespace chrono = std::chrono;
  const auto number = [&](std::size_t part) { return std::stoi(parts[part]); };
  const chrono::year_month_day day(chrono::year(number(1)), chrono::month(static_cast<unsigned>(number(2))),
                                   chrono::day(static_cast<unsigned>(number(3))));
  if (!day.ok() || number(4) > 23 || number(5) > 59 || number(6) > 59) return std::nullopt;
  const auto seconds = chrono::sys_days(day).time_since_epoch() + chrono::hours(number(4)) +
                       chrono::minutes(number(5)) + chrono::seconds(number(6));
  std::string fraction = parts[7];
  fraction.resize(9, '0');
  return chrono::nanoseconds(seconds).count() + std::stoi(fraction);
}

}  // namespace

std::optional<survey::StampNs> StampFromText(const std::string& text) {
  // From 1678 to 2261 nanoseconds fit; logs are younger.
  static const std::regex kUtc(R"((19\d\d|20\d\d|21\d\d)-(\d\d)-(\d\d)T(\d\d):(\d\d):(\d\d)(?:\.(\d{1,9}))?Z)");
  std::smatch parts;
  if (std::regex_match(text, parts, kUtc)) return StampOfUtc(parts);
  survey::StampNs stamp = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), stamp);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(stamp) : std::nullopt;
}

}  // namespace formats
