// SPDX-License-Identifier: Apache-2.0
//
// Small pieces of HTML and SVG text. All text from outside passes Escaped().
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace formats {

inline constexpr const char* kDash = "&ndash;";  // in a table: no such value

std::string Escaped(std::string_view text);
std::string Fixed(double value, int decimals);          // "-0.00" prints as "0.00"
std::string Millimetres(double metres);                 // "12.3"
std::string Count(int count, const std::string& what);  // "1 point", "3 points"
std::string Base64(std::string_view bytes);

// Text that is HTML already, in a paragraph (of a class), a heading, a figure with its caption.
std::string P(const std::string& html, const std::string& kind = "");
std::string H2(const std::string& html);
std::string Figure(const std::string& svg, const std::string& caption);

// A table; cells are HTML already. Short ones are kept on one page. Columns from `first_number` on are set
// right-aligned.
class HtmlTable {
 public:
  HtmlTable(std::initializer_list<std::string> heads, std::size_t first_number);
  void Row(const std::vector<std::string>& cells, const std::string& row_class = "");
  bool empty() const { return rows_.empty(); }
  std::string Text() const;

 private:
  std::string Cells(const std::vector<std::string>& cells, const std::string& tag) const;

  std::string head_;
  std::string rows_;
  int num_rows_ = 0;
  std::size_t first_number_;
};

}  // namespace formats
