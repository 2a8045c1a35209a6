// SPDX-License-Identifier: Apache-2.0
//
// Tables as aligned text: for people, in reports of `show`.
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace formats {

// printf of one number: Number(12.3456, "%.2f").
std::string Number(double value, const char* format);

// Seconds with nine decimals, exactly.
std::string SecondsOfNs(std::int64_t ns);

// Control characters shown as \n, \t, \xNN, so that a text stays on its line.
std::string OneLine(std::string_view text);

class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : header_(std::move(header)) {}

  // Calls `row` with the cells of each row in order.
  using Rows = std::function<void(const std::function<void(const std::vector<std::string>&)>& row)>;

  // Runs through the rows twice, for the widths and for the text, so that long tables need no memory. Numbers are
  // aligned to the right.
  void Print(std::ostream& out, const Rows& rows) const;

 private:
  std::vector<std::string> header_;
};

}  // namespace formats
