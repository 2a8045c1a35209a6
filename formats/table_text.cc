// SPDX-License-Identifier: Apache-2.0
#include "formats/table_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "formats/text_table.h"

namespace formats {
namespace {

struct Column {
  std::string name;
  std::string title;
  double largest = 0.0;  // magnitude of its finite real numbers
};

std::string SummaryOfRanges(std::span<const std::byte> bytes) {
  float least = 0.0F;
  float largest = 0.0F;
  int finite = 0;
  int no_return = 0;
  int invalid = 0;
  for (std::size_t offset = 0; offset + sizeof(float) <= bytes.size(); offset += sizeof(float)) {
    float range = 0.0F;
    std::memcpy(&range, bytes.data() + offset, sizeof range);
    if (std::isnan(range)) {
      ++invalid;
    } else if (std::isinf(range)) {
      ++no_return;
    } else {
      least = finite == 0 ? range : std::min(least, range);
      largest = finite == 0 ? range : std::max(largest, range);
      ++finite;
    }
  }
  const std::string reach = finite == 0 ? "" : " " + Number(least, "%.3f") + ".." + Number(largest, "%.3f") + " m";
  return std::to_string(finite) + reach + ", " + std::to_string(no_return) + " no return, " + std::to_string(invalid) +
         " invalid";
}

const char* FormatOfReals(const Column& column) {
  if (column.name.starts_with("angle_") || column.name.starts_with("time_")) return "%.9f";
  return column.name.starts_with("cov_") || (column.largest > 0.0 && column.largest < 1e-3) ? "%.3e" : "%.6f";
}

std::string Cell(const Statement& row, int index, const Column& column) {
  switch (row.Type(index)) {
    case ColumnType::kInteger:
      if (column.name.ends_with("_ns")) return SecondsOfNs(row.Integer(index));
      return std::to_string(row.Integer(index));
    case ColumnType::kReal:
      return Number(row.Real(index), FormatOfReals(column));
    case ColumnType::kText:
      return OneLine(row.Text(index));
    case ColumnType::kBlob:
      return SummaryOfRanges(row.Blob(index));
    case ColumnType::kNull:
      break;
  }
  return "-";
}

std::vector<Column> ColumnsOf(Statement& select) {
  std::vector<Column> columns;
  for (int i = 0; i < select.num_columns(); ++i) {
    const std::string name = select.ColumnName(i);
    columns.push_back({name, name.ends_with("_ns") ? name.substr(0, name.size() - 3) + " (s)" : name});
  }
  while (select.Step()) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const int index = static_cast<int>(i);
      if (select.Type(index) == ColumnType::kReal && std::isfinite(select.Real(index)))
        columns[i].largest = std::max(columns[i].largest, std::abs(select.Real(index)));
    }
  }
  select.Reset();
  return columns;
}

void PrintTable(Database& database, const std::string& table, std::int64_t num_rows, std::ostream& out) {
  Statement select = database.Prepare("SELECT * FROM " + table + " ORDER BY rowid");
  const std::vector<Column> columns = ColumnsOf(select);
  const bool single = num_rows == 1 && columns.front().name == "id";
  std::vector<std::string> titles;
  for (const Column& column : columns) titles.push_back(column.title);
  out << "\n" << table << "\n";
  TextTable(single ? std::vector<std::string>{"name", "value"} : titles).Print(out, [&](const auto& print) {
    while (select.Step()) {
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < columns.size(); ++i) cells.push_back(Cell(select, static_cast<int>(i), columns[i]));
      if (!single) {
        print(cells);
        continue;
      }
      for (std::size_t i = 1; i < cells.size(); ++i) print({titles[i], cells[i]});
    }
    select.Reset();
  });
}

}  // namespace

void PrintTables(Database& database, std::ostream& out) {
  std::vector<std::pair<std::string, std::int64_t>> tables;
  Statement select = database.Prepare(
      "SELECT m.name, m.num_rows FROM end_marker AS m JOIN sqlite_schema AS s ON s.name = m.name "
      "WHERE m.name <> 'provenance' ORDER BY s.rowid");
  while (select.Step()) tables.emplace_back(select.Text(0), select.Integer(1));
  out << "\nrows";
  for (const auto& [table, num_rows] : tables)
    out << " " << table << " " << num_rows << (table == tables.back().first ? "\n" : ",");
  for (const auto& [table, num_rows] : tables) {
    if (num_rows > 0) PrintTable(database, table, num_rows, out);
  }
}

}  // namespace formats
