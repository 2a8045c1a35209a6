// SPDX-License-Identifier: Apache-2.0
//
// Numbers as people and programs write them in text files, with a decimal point whatever the locale. Nothing is
// accepted that is not a finite number to its last character.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "survey/sensors/session.h"

namespace formats {

std::string_view Trimmed(std::string_view text);  // without blanks and tabs at both ends

std::optional<double> ParseNumber(std::string_view text);
std::optional<float> ParseFloat(std::string_view text);
std::optional<long long> ParseInteger(std::string_view text);

// Seconds to nanoseconds without a detour over binary fractions; digits below a nanosecond are rounded.
std::optional<survey::StampNs> ParseStamp(std::string_view text);

// Seconds with as many decimals as the stamp needs (at least one).
std::string StampText(survey::StampNs stamp_ns);

// Shortest text that reads back to the same number.
std::string NumberText(double value);

// What is wrong with a text that ParseNumber refused, as the end of a message.
std::string WhyNotANumber(std::string_view text);

}  // namespace formats
