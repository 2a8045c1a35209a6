// SPDX-License-Identifier: Apache-2.0
#include "formats/text_table.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace formats {
namespace {

// Characters, not bytes, of UTF-8.
std::size_t WidthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

bool LooksLikeNumber(const std::string& cell) {
  return cell.empty() || cell == "-" || cell.find_first_not_of("+-.0123456789e") == std::string::npos ||
         cell == "inf" || cell == "nan" || cell == "-inf";
}

}  // namespace

std::string Number(double value, const char* format) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string SecondsOfNs(std::int64_t ns) {
  const std::uint64_t magnitude = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%s%llu.%09llu", ns < 0 ? "-" : "",
                static_cast<unsigned long long>(magnitude / 1'000'000'000),
                static_cast<unsigned long long>(magnitude % 1'000'000'000));
  return buffer;
}

std::string OneLine(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n') {
      line += "\\n";
    } else if (c == '\t') {
      line += "\\t";
    } else if (code < 0x20 || code == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", code);
      line += escape;
    } else {
      line += c;
    }
  }
  return line;
}

void TextTable::Print(std::ostream& out, const Rows& rows) const {
  std::vector<std::size_t> widths;
  for (const std::string& title : header_) widths.push_back(WidthOf(title));
  std::vector<bool> right(header_.size(), true);
  rows([&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], WidthOf(cells[i]));
      right[i] = right[i] && LooksLikeNumber(cells[i]);
    }
  });
  const auto print = [&](const std::vector<std::string>& cells) {
    std::string line = " ";
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string padding(widths[i] - WidthOf(cells[i]), ' ');
      line += " " + (right[i] ? padding + cells[i] : cells[i] + padding);
      if (i + 1 < cells.size()) line += " ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << "\n";
  };
  print(header_);
  rows(print);
}

}  // namespace formats
