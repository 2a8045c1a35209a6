// SPDX-License-Identifier: Apache-2.0
//
// Words and numbers of DynAdjust's files: station, measurement and adjustment output.
#pragma once

#include <string>
#include <vector>

namespace test_support {

std::vector<std::string> Words(const std::string& line);
// Numbers that have a decimal point; the columns of a covariance may touch each other.
std::vector<double> Decimals(const std::string& line);
// First word of some columns; empty where there is none.
std::string Field(const std::string& line, std::size_t begin, std::size_t size);
// "-37 47 52.0000" in arc seconds, or a length.
double Value(const std::string& text, bool angular);
// "-37.481370003": degrees, minutes and seconds in the decimals, to degrees.
double PackedDegrees(const std::string& text);

}  // namespace test_support
