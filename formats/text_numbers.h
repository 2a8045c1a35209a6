// SPDX-License-Identifier: Apache-2.0
//
// Numbers as people and programs write them in text files, with a decimal point whatever the locale. Nothing is
// accepted that is not a finite number to its last character.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "survey/sensors/session.h"

namespace formats {

std::string_view Trimmed(std::string_view text);  // without blanks and tabs at both ends

std::optional<double> ParseNumber(std::string_view text);
std::optional<float> ParseFloat(std::string_view text);
std::optional<long long> ParseInteger(std::string_view text);

// Reads a plain decimal number at `begin`: perhaps '-', digits, perhaps '.' and more digits; as many as T holds exactly
// (7 in a float, 15 in a double). The digits as an integer and the power of ten below them are then both exact, and
// their quotient is the number nearest to the text, as strtod gives it (W. Clinger: How to read floating point numbers
// accurately, PLDI 1990). Returns where the number ends; null when the text is not that plain, which says nothing
// about whether it is a number.
template <typename T>
const char* ScanPlainNumber(const char* begin, const char* end, T* value) {
  constexpr int kMostDigits = std::numeric_limits<T>::digits10 + (std::is_same_v<T, float> ? 1 : 0);
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>);
  constexpr std::array<T, 16> kPowers = {1e0F, 1e1F, 1e2F,  1e3F,    1e4F,    1e5F,    1e6F,    1e7F,
                                         1e8F, 1e9F, 1e10F, T(1e11), T(1e12), T(1e13), T(1e14), T(1e15)};
  const char* next = begin;
  const bool negative = next != end && *next == '-';
  if (negative) ++next;
  std::int64_t digits = 0;
  const auto take_digits = [&] {
    const char* const first = next;
    for (; next != end && *next >= '0' && *next <= '9' && next - first <= kMostDigits; ++next)
      digits = 10 * digits + (*next - '0');
    return static_cast<int>(next - first);
  };
  const int whole = take_digits();
  int decimals = 0;
  if (next != end && *next == '.') {
    ++next;
    decimals = take_digits();
  }
  if (whole == 0 || whole + decimals > kMostDigits) return nullptr;
  if (next != end && ((*next >= '0' && *next <= '9') || *next == '.' || *next == 'e' || *next == 'E')) return nullptr;
  const T magnitude = static_cast<T>(digits) / kPowers[static_cast<std::size_t>(decimals)];
  *value = negative ? -magnitude : magnitude;
  return next;
}

// Seconds to nanoseconds without a detour over binary fractions; digits below a nanosecond are rounded.
std::optional<survey::StampNs> ParseStamp(std::string_view text);

// Seconds with as many decimals as the stamp needs (at least one).
std::string StampText(survey::StampNs stamp_ns);

// Shortest text that reads back to the same number.
std::string NumberText(double value);

// What is wrong with a text that ParseNumber refused, as the end of a message.
std::string WhyNotANumber(std::string_view text);

}  // namespace formats
