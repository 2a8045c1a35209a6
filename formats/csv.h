// SPDX-License-Identifier: Apache-2.0
//
// Strict reading of comma-separated numbers with a header line: '#' comments and blank lines are skipped, a byte-order
// mark, CRLF and quotes around a field are accepted; anything else that is not as the format says is a DataError naming
// file, row, field, value and rule.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/line_reader.h"
#include "survey/sensors/session.h"

namespace formats {

class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& file);

  // Reads the header row, which must name exactly these columns in this order. From then on every row must have as many
  // fields.
  void ReadHeader(const std::vector<std::string>& columns);

  // The next row with fields; false at the end of the file.
  bool NextRow();

  // The same in two steps, for readers that take most rows as they stand: the text of the next row, then its fields.
  bool NextRowText(std::string_view* text);
  void SplitRow();

  // The line of the next row as it stands, comment or not; for headers of another form. False at the end of the file.
  bool NextLine(std::string_view* line) { return lines_.Next(line); }

  const std::vector<std::string_view>& fields() const { return fields_; }
  double Number(std::size_t field) const;
  survey::StampNs Stamp(std::size_t field) const;
  std::string_view Text(std::size_t field) const;  // not empty

  const std::filesystem::path& file() const { return lines_.file(); }
  int row() const { return lines_.line_number(); }
  // Error in one field of this row: "file:row: column = "value": rule".
  [[noreturn]] void Fail(std::size_t field, const std::string& rule) const;
  // Error of the row as a whole: "file:row: what", with a word when the file seems cut off here.
  [[noreturn]] void FailRow(const std::string& what) const;

 private:
  LineReader lines_;
  std::string_view row_text_;
  std::vector<std::string> columns_;
  std::vector<std::string_view> fields_;
};

}  // namespace formats
