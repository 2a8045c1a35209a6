// SPDX-License-Identifier: Apache-2.0
#include "formats/html.h"

#include <cstdint>
#include <cstdio>

namespace formats {
namespace {

constexpr int kShortTable = 20;

}  // namespace

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Fixed(double value, int decimals) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
  const std::string text = buffer;
  return text.starts_with('-') && text.find_first_of("123456789") == std::string::npos ? text.substr(1) : text;
}

std::string Millimetres(double metres) { return Fixed(metres * 1000.0, 1); }

std::string Count(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[(group >> (18U - 6U * k)) & 63U] : '=';
  }
  return text;
}

std::string P(const std::string& text, const std::string& kind) {
  return (kind.empty() ? "<p>" : "<p class=\"" + kind + "\">") + text + "</p>\n";
}

std::string H2(const std::string& text) { return "<h2>" + text + "</h2>\n"; }

std::string Figure(const std::string& svg, const std::string& caption) {
  return "<figure>" + svg + "<figcaption>" + caption + "</figcaption></figure>\n";
}

HtmlTable::HtmlTable(std::initializer_list<std::string> heads, std::size_t first_number) : first_number_(first_number) {
  head_ = "<thead><tr>" + Cells(heads, "th") + "</tr></thead>";
}

void HtmlTable::Row(const std::vector<std::string>& cells, const std::string& row_class) {
  rows_ += (row_class.empty() ? "<tr>" : "<tr class=\"" + row_class + "\">") + Cells(cells, "td") + "</tr>\n";
  ++num_rows_;
}

std::string HtmlTable::Cells(const std::vector<std::string>& cells, const std::string& tag) const {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += "<" + tag + (i >= first_number_ ? " class=\"num\">" : ">") + cells[i] + "</" + tag + ">";
  }
  return text;
}

std::string HtmlTable::Text() const {
  return (num_rows_ <= kShortTable ? "<table class=\"short\">" : "<table>") + head_ + "<tbody>\n" + rows_ +
         "</tbody></table>\n";
}

}  // namespace formats
