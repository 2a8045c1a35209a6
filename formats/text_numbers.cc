// SPDX-License-Identifier: Apache-2.0
#include "formats/text_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace formats {
namespace {

using survey::StampNs;

constexpr StampNs kNsPerSecond = 1'000'000'000;

template <typename T>
std::optional<T> Parse(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

template <typename T>
std::optional<T> ParseFinite(std::string_view text) {
  const char* const end = text.data() + text.size();
  T plain{};
  if (!text.empty() && ScanPlainNumber(text.data(), end, &plain) == end) return plain;
  const std::optional<T> value = Parse<T>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> ParseNumber(std::string_view text) { return ParseFinite<double>(text); }
std::optional<float> ParseFloat(std::string_view text) { return ParseFinite<float>(text); }
std::optional<long long> ParseInteger(std::string_view text) { return Parse<long long>(text); }

std::optional<StampNs> ParseStamp(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  int exponent = 9;  // of the digits read as one integer, in nanoseconds
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    const std::optional<long long> given = ParseInteger(text.substr(e + 1));
    if (!given || std::abs(*given) > 40) return std::nullopt;
    exponent += static_cast<int>(*given);
    text = text.substr(0, e);
  }
  // Digits with their weight 10^exponent; those below a nanosecond only round.
  const std::size_t point = text.find('.');
  const auto whole = static_cast<int>(point == std::string_view::npos ? text.size() : point);
  int weight = whole - 1 + exponent;
  StampNs ns = 0;
  bool any = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i == point) continue;
    if (!IsDigit(text[i])) return std::nullopt;
    any = true;
    const int digit = text[i] - '0';
    if (weight > 18 && digit != 0) return std::nullopt;
    if (weight >= 0 && weight <= 18) {
      if (ns > (std::numeric_limits<StampNs>::max() - digit) / 10) return std::nullopt;
      ns = ns * 10 + digit;
    } else if (weight == -1 && digit >= 5) {
      ++ns;
    }
    --weight;
  }
  if (!any) return std::nullopt;
  for (; weight >= 0; --weight) {
    if (ns > std::numeric_limits<StampNs>::max() / 10) return std::nullopt;
    ns *= 10;
  }
  // Room for sums of a few stamps.
  if (ns > std::numeric_limits<StampNs>::max() / 4) return std::nullopt;
  return negative ? -ns : ns;
}

std::string StampText(StampNs stamp_ns) {
  const bool negative = stamp_ns < 0;
  const StampNs magnitude = negative ? -stamp_ns : stamp_ns;
  std::string decimals = std::to_string(magnitude % kNsPerSecond);
  decimals.insert(0, 9 - decimals.size(), '0');
  decimals.erase(std::max<std::size_t>(decimals.find_last_not_of('0') + 1, 1));
  return (negative ? "-" : "") + std::to_string(magnitude / kNsPerSecond) + "." + decimals;
}

std::string NumberText(double value) {
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return error == std::errc() ? std::string(buffer, end) : std::string();
}

std::string WhyNotANumber(std::string_view text) {
  if (text.empty()) return "is empty, expected a number";
  std::string dotted(text);
  if (const std::size_t comma = dotted.find(','); comma != std::string::npos) {
    dotted[comma] = '.';
    if (ParseNumber(dotted)) return "decimal comma: write numbers with a decimal point";
  }
  if (const std::optional<double> value = Parse<double>(text); value && !std::isfinite(*value))
    return "must be a finite number";
  return "is not a number";
}

}  // namespace formats
