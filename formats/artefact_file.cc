// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_file.h"

#include <bit>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

static_assert(std::endian::native == std::endian::little, "blobs and digests are little-endian");

std::span<const std::byte> BytesOf(const std::vector<float>& values) {
  return std::as_bytes(std::span<const float>(values));
}

// Adds the statement's current row to the digest and keeps its types and numbers. False when a blob does not agree with
// the CRC-32 beside it.
bool DigestRow(const Statement& row, TableDigest& digest, std::vector<ColumnValue>& values) {
  bool blobs_whole = true;
  values.resize(static_cast<std::size_t>(row.num_columns()));
  for (int column = 0; column < row.num_columns(); ++column) {
    ColumnValue& value = values[static_cast<std::size_t>(column)];
    value.type = row.Type(column);
    switch (value.type) {
      case ColumnType::kInteger:
        digest.AddInteger(value.integer = row.Integer(column));
        break;
      case ColumnType::kReal:
        digest.AddReal(value.real = row.Real(column));
        break;
      case ColumnType::kText:
        digest.AddText(row.Text(column));
        break;
      case ColumnType::kBlob:
        digest.AddBlobLength(row.Blob(column).size());
        blobs_whole = blobs_whole && column + 1 < row.num_columns() &&
                      std::int64_t{Crc32(row.Blob(column))} == row.Integer(column + 1);
        break;
      case ColumnType::kNull:
        digest.AddNull();
        break;
    }
  }
  digest.EndRow();
  return blobs_whole;
}

Statement SelectAll(Database& database, const std::string& table) {
  return database.Prepare("SELECT * FROM " + table + " ORDER BY rowid");
}

std::string InsertInto(Database& database, const std::string& table) {
  std::string sql = "INSERT INTO " + table + " VALUES (?";
  for (int column = 1; column < SelectAll(database, table).num_columns(); ++column) sql += ",?";
  return sql + ")";
}

std::vector<std::string> SchemaOf(Database& database) {
  std::vector<std::string> schema;
  Statement select = database.Prepare("SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_schema");
  while (select.Step()) {
    std::string entry;
    for (int column = 0; column < 4; ++column) entry += std::string(select.Text(column)) + '\n';
    schema.push_back(std::move(entry));
  }
  return schema;
}

std::vector<std::string> TablesOf(Database& database) {
  std::vector<std::string> tables;
  Statement select = database.Prepare("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY rowid");
  while (select.Step()) tables.emplace_back(select.Text(0));
  return tables;
}

std::string FullSchema(ArtefactKind kind) { return std::string(kCommonSchema) + std::string(FormatOf(kind).schema); }

// As SQLite itself lists it.
std::vector<std::string> ExpectedSchema(ArtefactKind kind) {
  Database database = Database::InMemory();
  database.Execute(FullSchema(kind));
  return SchemaOf(database);
}

// SQLite reads a file that ends within a page as if zeros followed.
void CheckSize(Database& database) {
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(database.file()));
  const std::int64_t expected = database.Integer("PRAGMA page_size") * database.Integer("PRAGMA page_count");
  if (size != expected) {
    throw DataError(database.file().string() + ": damaged: " + std::to_string(size) + " bytes, expected " +
                    std::to_string(expected) + (size < expected ? " (truncated)" : ""));
  }
}

ArtefactKind KindOf(Database& database) {
  const std::string file = database.file().string();
  if (database.Integer("PRAGMA application_id") != kApplicationId)
    throw DataError(file + ": an SQLite file, but not one of Plumbline's");
  const auto user_version = static_cast<int>(database.Integer("PRAGMA user_version"));
  const std::optional<ArtefactKind> kind = KindOfUserVersion(user_version);
  if (!kind) throw DataError(file + ": artefact of unknown kind " + std::to_string(user_version));
  const ArtefactFormat& format = FormatOf(*kind);
  if (user_version != format.UserVersion()) {
    throw DataError(file + ": " + std::string(format.name) + " file of format version " +
                    std::to_string(user_version % 100) + "; this program reads version " +
                    std::to_string(format.version));
  }
  return *kind;
}

void CheckSchema(Database& database, ArtefactKind kind) {
  if (SchemaOf(database) != ExpectedSchema(kind))
    throw DataError(database.file().string() + ": damaged: its schema is not that of a " +
                    std::string(FormatOf(kind).name) + " file");
}

void CheckForeignKeys(Database& database) {
  Statement check = database.Prepare("PRAGMA foreign_key_check");
  if (check.Step())
    throw DataError(database.file().string() + ": damaged: table " + std::string(check.Text(0)) +
                    " refers to a row of " + std::string(check.Text(2)) + " that is not there");
}

// Throws DataError unless the end marker knows the table with this digest.
void HoldTableAgainstEndMarker(Database& database, const std::string& table, const TableDigest& digest) {
  const std::string where = database.file().string() + ": damaged: ";
  Statement select = database.Prepare("SELECT num_rows, crc32 FROM end_marker WHERE name = ?");
  select.Bind(1, std::string_view(table));
  if (!select.Step()) throw DataError(where + "no end marker for table " + table + " (truncated?)");
  if (select.Integer(0) != digest.num_rows() || select.Integer(1) != digest.crc32())
    throw DataError(where + "table " + table + " does not agree with its end marker");
}

}  // namespace

void TableDigest::Add(char letter, std::uint64_t bits) {
  char bytes[9];
  bytes[0] = letter;
  std::memcpy(bytes + 1, &bits, sizeof bits);
  row_.append(bytes, sizeof bytes);
}

void TableDigest::AddReal(double value) {
  Add('r', std::bit_cast<std::uint64_t>(value + 0.0));  // SQLite stores -0 as 0
}

void TableDigest::AddText(std::string_view text) {
  Add('t', text.size());
  row_ += text;
}

void TableDigest::EndRow() {
  crc32_ = Crc32(std::as_bytes(std::span<const char>(row_)), crc32_);
  ++num_rows_;
  row_.clear();
}

TableWriter::TableWriter(Database& database, const std::string& table)
    : table_(table), insert_(database.Prepare(InsertInto(database, table))) {}

void TableWriter::PutInteger(std::int64_t value) {
  insert_.Bind(++column_, value);
  digest_.AddInteger(value);
}

void TableWriter::PutReal(double value) {
  insert_.Bind(++column_, value);
  if (std::isnan(value)) {
    digest_.AddNull();
  } else {
    digest_.AddReal(value);
  }
}

void TableWriter::Put(std::string_view text) {
  insert_.Bind(++column_, text);
  digest_.AddText(text);
}

void TableWriter::Put(const survey::Pose2& pose) { Put(pose.Vector()); }

void TableWriter::Put(const Eigen::Vector2d& v) {
  PutReal(v.x());
  PutReal(v.y());
}

void TableWriter::Put(const Eigen::Vector3d& v) {
  for (const double value : v) PutReal(value);
}

void TableWriter::Put(const Eigen::Matrix2d& m) {
  for (const double value : {m(0, 0), m(0, 1), m(1, 1)}) PutReal(value);
}

void TableWriter::Put(const Eigen::Matrix3d& m) {
  for (const double value : {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}) PutReal(value);
}

void TableWriter::Put(std::span<const float> values) {
  canonical_.assign(values.begin(), values.end());
  for (float& value : canonical_) {
    if (std::isnan(value)) value = std::numeric_limits<float>::quiet_NaN();
  }
  insert_.Bind(++column_, BytesOf(canonical_));
  digest_.AddBlobLength(BytesOf(canonical_).size());
  PutInteger(Crc32(BytesOf(canonical_)));
}

void TableWriter::EndRow() {
  if (column_ != insert_.num_parameters())
    throw std::logic_error("table " + table_ + ": a row of " + std::to_string(column_) + " values");
  insert_.Step();
  insert_.Reset();
  digest_.EndRow();
  column_ = 0;
}

TableReader::TableReader(Database& database, const std::string& table)
    : database_(database), table_(table), select_(SelectAll(database, table)) {}

bool TableReader::Next() {
  column_ = 0;
  if (!select_.Step()) return false;
  Require(DigestRow(select_, digest_, row_), "the bytes do not agree with their CRC-32");
  return true;
}

void TableReader::HoldAgainstEndMarker() const { HoldTableAgainstEndMarker(database_, table_, digest_); }

void TableReader::Fail(std::string_view rule) const {
  throw DataError(database_.file().string() + ": damaged: table " + table_ + ", row " + std::to_string(row()) + ": " +
                  std::string(rule));
}

int TableReader::NextColumn(ColumnType expected) {
  const int column = column_++;
  Require(column < std::ssize(row_) && row_[static_cast<std::size_t>(column)].type == expected,
          "a value of another type");
  return column;
}

std::int64_t TableReader::GetInteger() {
  return row_[static_cast<std::size_t>(NextColumn(ColumnType::kInteger))].integer;
}

double TableReader::GetReal() {
  if (column_ < std::ssize(row_) && row_[static_cast<std::size_t>(column_)].type == ColumnType::kNull) {
    ++column_;
    return std::numeric_limits<double>::quiet_NaN();
  }
  return row_[static_cast<std::size_t>(NextColumn(ColumnType::kReal))].real;
}

void TableReader::Get(std::optional<double>& value) {
  const double real = GetReal();
  value = std::isnan(real) ? std::nullopt : std::optional(real);
}

void TableReader::Get(std::string& text) { text = select_.Text(NextColumn(ColumnType::kText)); }

void TableReader::Get(survey::Pose2& pose) {
  Eigen::Vector3d v;
  Get(v);
  pose = survey::Pose2::FromVector(v);
}

void TableReader::Get(Eigen::Vector2d& v) {
  for (double& value : v) value = GetReal();
}

void TableReader::Get(Eigen::Vector3d& v) {
  for (double& value : v) value = GetReal();
}

void TableReader::Get(Eigen::Matrix2d& m) {
  const double xx = GetReal(), xy = GetReal(), yy = GetReal();
  m << xx, xy, xy, yy;
}

void TableReader::Get(Eigen::Matrix3d& m) {
  const double xx = GetReal(), xy = GetReal(), xt = GetReal(), yy = GetReal(), yt = GetReal(), tt = GetReal();
  m << xx, xy, xt, xy, yy, yt, xt, yt, tt;
}

void TableReader::Get(std::vector<float>& values) {
  const std::span<const std::byte> bytes = select_.Blob(NextColumn(ColumnType::kBlob));
  Require(bytes.size() % sizeof(float) == 0, "bytes that are not whole float32 numbers");
  values.resize(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  GetInteger();  // the CRC-32, compared by Next
}

ArtefactWriter::ArtefactWriter(const std::filesystem::path& file, ArtefactKind kind, const Provenance& provenance)
    : file_(file), database_(Database::Create(file_.temporary(), file)) {
  database_->Execute("BEGIN;PRAGMA application_id = " + std::to_string(kApplicationId) +
                     ";PRAGMA user_version = " + std::to_string(FormatOf(kind).UserVersion()) + ";" + FullSchema(kind));
  Table("provenance", [&](TableWriter& row) {
    int position = 0;
    for (nlohmann::json& record : ToJson(provenance)) {
      const std::string id = record.at("id");
      record.erase("id");
      row(position++, id, record.at("stage").get<std::string>(), JsonText(record));
    }
  });
}

bool ArtefactWriter::Commit() {
  const auto digests = std::move(tables_);
  Table("end_marker", [&](TableWriter& row) {
    for (const auto& [name, digest] : digests) row(name, digest.num_rows(), digest.crc32());
  });
  database_->Execute("COMMIT");
  database_.reset();
  return file_.Commit();
}

ArtefactReader::ArtefactReader(const std::filesystem::path& file) : database_(Database::OpenForReading(file)) {
  CheckSize(database_);
  CheckSchema(database_, KindOf(database_));
}

ArtefactReader::ArtefactReader(const std::filesystem::path& file, ArtefactKind kind) : ArtefactReader(file) {
  const ArtefactKind found = KindOf(database_);
  if (found != kind) {
    throw DataError(file.string() + ": a " + std::string(FormatOf(found).name) + " file, expected a " +
                    std::string(FormatOf(kind).name) + " file");
  }
  CheckForeignKeys(database_);
}

Provenance ArtefactReader::ReadProvenance() {
  nlohmann::json records = nlohmann::json::array();
  Table("provenance", [&](TableReader& row) {
    std::int64_t position = 0;
    std::string id, stage, record;
    row(position, id, stage, record);
    row.Require(position == row.row(), "positions must count from 0");
    nlohmann::json json = JsonOrDiscarded(record);
    row.Require(json.is_object(), "the record is not JSON");
    json["id"] = id;
    records.push_back(std::move(json));
  });
  try {
    return ProvenanceFromJson(records);
  } catch (const DataError& error) {
    throw DataError(database_.file().string() + ": damaged: " + error.what());
  }
}

void ArtefactReader::RequireOneRow(const std::string& table, std::size_t num_rows) const {
  if (num_rows != 1) throw DataError(database_.file().string() + ": damaged: table " + table + " must have one row");
}

ArtefactKind KindOfArtefact(const std::filesystem::path& file) {
  Database database = Database::OpenForReading(file);
  return KindOf(database);
}

std::vector<std::string> ExamineArtefact(const std::filesystem::path& file) {
  std::vector<std::string> problems;
  const auto attempt = [&](const auto& examination) {
    try {
      examination();
    } catch (const DataError& error) {
      problems.emplace_back(error.what());
    }
  };
  attempt([&] {
    Database database = Database::OpenForReading(file);
    const ArtefactKind kind = KindOf(database);
    attempt([&] { CheckSize(database); });
    attempt([&] { CheckSchema(database, kind); });
    attempt([&] { CheckForeignKeys(database); });
    attempt([&] {
      Statement check = database.Prepare("PRAGMA integrity_check(10)");
      while (check.Step()) {
        if (check.Text(0) != "ok") problems.push_back(file.string() + ": damaged: " + std::string(check.Text(0)));
      }
    });
    for (const std::string& table : TablesOf(database)) {
      if (table == "end_marker") continue;
      attempt([&] {
        TableDigest digest;
        std::vector<ColumnValue> row;
        Statement select = SelectAll(database, table);
        while (select.Step()) {
          if (!DigestRow(select, digest, row))
            problems.push_back(file.string() + ": damaged: table " + table + ", row " +
                               std::to_string(digest.num_rows() - 1) + ": the bytes do not agree with their CRC-32");
        }
        HoldTableAgainstEndMarker(database, table, digest);
      });
    }
  });
  return problems;
}

}  // namespace formats
