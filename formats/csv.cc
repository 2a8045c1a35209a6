// SPDX-License-Identifier: Apache-2.0
#include "formats/csv.h"

#include <algorithm>
#include <cstring>

#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file) : lines_(file) {}

bool CsvReader::NextRow() {
  std::string_view text;
  if (!NextRowText(&text)) return false;
  SplitRow();
  return true;
}

bool CsvReader::NextRowText(std::string_view* text) {
  do {
    if (!lines_.Next(&row_text_)) return false;
    row_text_ = Trimmed(row_text_);
  } while (row_text_.empty() || row_text_.front() == '#');
  *text = row_text_;
  return true;
}

void CsvReader::SplitRow() {
  fields_.clear();
  const char* begin = row_text_.data();
  const char* const end = begin + row_text_.size();
  while (true) {
    const char* comma = static_cast<const char*>(std::memchr(begin, ',', static_cast<std::size_t>(end - begin)));
    const char* stop = comma != nullptr ? comma : end;
    std::string_view field = Trimmed({begin, static_cast<std::size_t>(stop - begin)});
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields_.push_back(field);
    if (comma == nullptr) break;
    begin = comma + 1;
  }
  if (!columns_.empty() && fields_.size() != columns_.size()) {
    std::string hint;
    if (fields_.size() == 1 && row_text_.find(';') != std::string_view::npos)
      hint = "; separate fields by commas, not semicolons, and write numbers with a decimal point";
    if (fields_.size() > columns_.size()) hint = "; a decimal comma? Write numbers with a decimal point";
    FailRow(std::to_string(fields_.size()) + " fields, expected " + std::to_string(columns_.size()) + " (" +
            Joined(columns_) + ")" + hint);
  }
}

void CsvReader::ReadHeader(const std::vector<std::string>& columns) {
  const std::string expected = Joined(columns);
  if (!NextRow()) throw DataError(file().string() + ": is empty, expected the header " + expected);
  if (!std::equal(fields_.begin(), fields_.end(), columns.begin(), columns.end())) {
    std::string found;
    for (const std::string_view field : fields_) found += (found.empty() ? "" : ",") + std::string(field);
    if (found.size() > 80) found = found.substr(0, 80) + "...";
    FailRow("header \"" + found + "\", expected " + expected);
  }
  columns_ = columns;
}

double CsvReader::Number(std::size_t field) const {
  const std::optional<double> number = ParseNumber(fields_[field]);
  if (!number) Fail(field, WhyNotANumber(fields_[field]));
  return *number;
}

survey::StampNs CsvReader::Stamp(std::size_t field) const {
  const std::optional<survey::StampNs> stamp = ParseStamp(fields_[field]);
  if (!stamp)
    Fail(field, ParseNumber(fields_[field]) ? "is too large for a time stamp" : WhyNotANumber(fields_[field]));
  return *stamp;
}

std::string_view CsvReader::Text(std::size_t field) const {
  if (fields_[field].empty()) Fail(field, "must not be empty");
  return fields_[field];
}

void CsvReader::Fail(std::size_t field, const std::string& rule) const {
  const std::string name = field < columns_.size() ? columns_[field] : "field " + std::to_string(field + 1);
  FailRow(name + " = \"" + std::string(fields_[field].substr(0, 80)) + "\": " + rule);
}

void CsvReader::FailRow(const std::string& what) const {
  throw DataError(lines_.Where() + ": " + what + (lines_.line_was_ended() ? "" : " (the file ends here: cut off?)"));
}

}  // namespace formats
