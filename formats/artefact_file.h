// SPDX-License-Identifier: Apache-2.0
//
// The frame of every SQLite artefact: identity, schema, provenance and an end marker with a digest of each table.
//
// A table's row is written by a list of values and read by the same list of variables, in the schema's order, so one
// generic function serves both ways:
//
//   constexpr auto kSubmapRow = [](auto& row, auto& submap) { row(submap.id, submap.local_from_submap); };
//
// One value takes as many columns as it has numbers: Pose2 three (x, y, theta), Vector2d two, Matrix2d three and
// Matrix3d six (upper triangle by rows), ScanStamp two, SubmapConstraint eleven, a vector<float> two (bytes and their
// CRC-32).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "formats/artefact_formats.h"
#include "formats/atomic_file.h"
#include "formats/provenance.h"
#include "formats/sqlite.h"
#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace formats {

// An enumeration stored by its survey::Name; `all` lists its values.
template <typename Enum>
struct Named {
  Enum& value;
  std::span<const std::remove_const_t<Enum>> all;
};
template <typename Enum, typename Container>
Named(Enum&, const Container&) -> Named<Enum>;

// CRC-32 over the values of a table, row by row. Each value counts as a letter and eight little-endian bytes:
// i and the integer, r and the IEEE double, t and the length followed by the UTF-8 bytes, b and the length (the bytes
// count through the CRC-32 in the column that follows), n and zero for NULL.
class TableDigest {
 public:
  void AddInteger(std::int64_t value) { Add('i', static_cast<std::uint64_t>(value)); }
  void AddReal(double value);
  void AddText(std::string_view text);
  void AddBlobLength(std::size_t size) { Add('b', size); }
  void AddNull() { Add('n', 0); }
  void EndRow();

  std::int64_t num_rows() const { return num_rows_; }
  std::int64_t crc32() const { return crc32_; }

 private:
  void Add(char letter, std::uint64_t bits);

  std::string row_;
  std::int64_t num_rows_ = 0;
  std::uint32_t crc32_ = 0;
};

// A column of a row that was read. SQLite takes its time over each question, so each is asked once.
struct ColumnValue {
  ColumnType type = ColumnType::kNull;
  std::int64_t integer = 0;
  double real = 0.0;
};

class TableWriter {
 public:
  // Writes one row. The number of values must be that of the table's columns.
  template <typename... Values>
  void operator()(const Values&... values) {
    (Put(values), ...);
    EndRow();
  }

 private:
  friend class ArtefactWriter;
  TableWriter(Database& database, const std::string& table);

  template <std::integral Value>
  void Put(Value value) {
    PutInteger(static_cast<std::int64_t>(value));
  }
  template <std::floating_point Value>
  void Put(Value value) {
    PutReal(static_cast<double>(value));
  }
  template <typename Enum>
  void Put(const Named<Enum>& named) {
    Put(Name(named.value));
  }
  void Put(const std::optional<double>& value) { PutReal(value.value_or(std::nan(""))); }
  void Put(std::string_view text);
  void Put(const std::string& text) { Put(std::string_view(text)); }
  void Put(survey::ScanId id) { PutInteger(id.value); }
  void Put(const survey::ScanStamp& stamp) {
    PutInteger(stamp.clock_ns);
    PutInteger(stamp.recorded_ns);
  }
  void Put(survey::SubmapId id) { PutInteger(id.value); }
  void Put(const survey::Pose2& pose);
  void Put(const Eigen::Vector2d& v);
  void Put(const Eigen::Vector3d& v);
  void Put(const Eigen::Matrix2d& m);
  void Put(const Eigen::Matrix3d& m);
  void Put(const survey::SubmapConstraint& constraint) {
    Put(constraint.submap);
    Put(constraint.scan);
    Put(constraint.submap_from_scan);
    Put(constraint.covariance);
  }
  void Put(std::span<const float> values);  // NaN becomes the canonical one

  void PutInteger(std::int64_t value);
  void PutReal(double value);  // NaN becomes NULL
  void EndRow();

  std::string table_;
  Statement insert_;
  TableDigest digest_;
  int column_ = 0;
  std::vector<float> canonical_;
};

class TableReader {
 public:
  // Reads the row's next columns into variables of the types that were written.
  template <typename... Values>
  void operator()(Values&&... values) {
    (Get(values), ...);
  }

  // For rules that the schema cannot state. Throws DataError naming file, table and row.
  void Require(bool holds, std::string_view rule) const {
    if (!holds) Fail(rule);
  }
  std::int64_t row() const { return digest_.num_rows() - 1; }  // of the current row, from 0

 private:
  friend class ArtefactReader;
  TableReader(Database& database, const std::string& table);
  bool Next();
  void HoldAgainstEndMarker() const;

  template <std::integral Value>
  void Get(Value& value) {
    const std::int64_t integer = GetInteger();
    value = static_cast<Value>(integer);
    Require(static_cast<std::int64_t>(value) == integer, "a number is out of range");
  }
  template <std::floating_point Value>
  void Get(Value& value) {
    value = static_cast<Value>(GetReal());
  }
  template <typename Enum>
  void Get(const Named<Enum>& named) {
    std::string text;
    Get(text);
    for (const Enum value : named.all) {
      if (Name(value) == text) {
        named.value = value;
        return;
      }
    }
    Fail("unknown word \"" + text + "\"");
  }
  void Get(std::optional<double>& value);
  void Get(std::string& text);
  void Get(survey::ScanId& id) { Get(id.value); }
  void Get(survey::ScanStamp& stamp) { (*this)(stamp.clock_ns, stamp.recorded_ns); }
  void Get(survey::SubmapId& id) { Get(id.value); }
  void Get(survey::Pose2& pose);
  void Get(Eigen::Vector2d& v);
  void Get(Eigen::Vector3d& v);
  void Get(Eigen::Matrix2d& m);
  void Get(Eigen::Matrix3d& m);
  void Get(survey::SubmapConstraint& constraint) {
    (*this)(constraint.submap, constraint.scan, constraint.submap_from_scan, constraint.covariance);
  }
  void Get(std::vector<float>& values);

  std::int64_t GetInteger();
  double GetReal();  // NULL reads as NaN
  int NextColumn(ColumnType expected);
  [[noreturn]] void Fail(std::string_view rule) const;

  Database& database_;
  std::string table_;
  Statement select_;
  TableDigest digest_;
  std::vector<ColumnValue> row_;
  int column_ = 0;
};

class ArtefactWriter {
 public:
  ArtefactWriter(const std::filesystem::path& file, ArtefactKind kind, const Provenance& provenance);

  // Writes a whole table: `write` gets the TableWriter and calls it once per row. Every table of the schema is written
  // once, parents of foreign keys first.
  template <typename Function>
  void Table(const std::string& name, Function&& write) {
    TableWriter table(*database_, name);
    write(table);
    tables_.emplace_back(name, table.digest_);
  }

  // End marker, sync, rename. True when the file changed.
  bool Commit();

 private:
  AtomicFile file_;
  std::optional<Database> database_;
  std::vector<std::pair<std::string, TableDigest>> tables_;
};

class ArtefactReader {
 public:
  // DataError when the file is not an artefact of that kind in this version, or damaged.
  ArtefactReader(const std::filesystem::path& file, ArtefactKind kind);
  // Of any kind, for its provenance: whether its tables fit each other is not looked at.
  explicit ArtefactReader(const std::filesystem::path& file);

  // Calls read(table) for each row in order, then holds the table against the end marker.
  template <typename Function>
  void Table(const std::string& name, Function&& read) {
    TableReader table(database_, name);
    while (table.Next()) read(table);
    table.HoldAgainstEndMarker();
  }

  Provenance ReadProvenance();
  void RequireOneRow(const std::string& table, std::size_t num_rows) const;

 private:
  Database database_;
};

// Tables whose first column counts from 0: row_function(table, id, item) lists the columns.
template <typename Item, typename RowFunction>
void WriteRows(ArtefactWriter& writer, const std::string& table, const std::vector<Item>& items,
               RowFunction row_function) {
  writer.Table(table, [&](TableWriter& row) {
    std::int64_t id = 0;
    for (const Item& item : items) {
      row_function(row, id, item);
      ++id;
    }
  });
}

template <typename Item, typename RowFunction>
std::vector<Item> ReadRows(ArtefactReader& reader, const std::string& table, RowFunction row_function) {
  std::vector<Item> items;
  reader.Table(table, [&](TableReader& row) {
    std::int64_t id = -1;
    row_function(row, id, items.emplace_back());
    row.Require(id == row.row(), "the first column must count from 0");
  });
  return items;
}

// A table with the one row 0.
template <typename Item, typename RowFunction>
void WriteOneRow(ArtefactWriter& writer, const std::string& table, const Item& item, RowFunction row_function) {
  writer.Table(table, [&](TableWriter& row) {
    std::int64_t id = 0;
    row_function(row, id, item);
  });
}

template <typename Item, typename RowFunction>
Item ReadOneRow(ArtefactReader& reader, const std::string& table, RowFunction row_function) {
  std::vector<Item> items = ReadRows<Item>(reader, table, row_function);
  reader.RequireOneRow(table, items.size());
  return std::move(items.front());
}

// What kind of artefact an SQLite file is. DataError when it is none, or of a version that this program does not read.
ArtefactKind KindOfArtefact(const std::filesystem::path& file);

// The ways in which an artefact is broken, in words; empty when it is whole: SQLite's own check, schema, foreign keys,
// the CRC-32 of each blob, each table against the end marker.
std::vector<std::string> ExamineArtefact(const std::filesystem::path& file);

}  // namespace formats
