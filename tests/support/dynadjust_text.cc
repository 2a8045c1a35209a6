// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dynadjust_text.h"

#include <cmath>
#include <regex>
#include <sstream>

namespace test_support {

std::vector<std::string> Words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::vector<double> Decimals(const std::string& line) {
  static const std::regex kDecimal(R"(-?\d+\.\d+(?:[eE][+-]\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator it(line.begin(), line.end(), kDecimal), end; it != end; ++it) {
    numbers.push_back(std::stod(it->str()));
  }
  return numbers;
}

std::string Field(const std::string& line, std::size_t begin, std::size_t size) {
  if (begin >= line.size()) return "";
  const std::vector<std::string> words = Words(line.substr(begin, size));
  return words.empty() ? "" : words.front();
}

double Value(const std::string& text, bool angular) {
  const std::vector<std::string> words = Words(text);
  if (!angular) return std::stod(words.at(0));
  const double sign = words.at(0).front() == '-' ? -1.0 : 1.0;
  return sign * (std::abs(std::stod(words.at(0))) * 3600.0 + std::stod(words.at(1)) * 60.0 + std::stod(words.at(2)));
}

double PackedDegrees(const std::string& text) {
  const bool negative = text.front() == '-';
  const std::size_t dot = text.find('.');
  const double degrees = std::abs(std::stod(text.substr(0, dot)));
  const std::string rest = text.substr(dot + 1);
  const double value =
      degrees + std::stod(rest.substr(0, 2)) / 60.0 + std::stod(rest.substr(2, 2) + "." + rest.substr(4)) / 3600.0;
  return negative ? -value : value;
}

}  // namespace test_support
