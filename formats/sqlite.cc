// SPDX-License-Identifier: Apache-2.0
#include "formats/sqlite.h"

#include <sqlite3.h>

#include <new>
#include <stdexcept>

#include "formats/errors.h"

namespace formats {
namespace {

// Bigger than any row of an artefact; keeps damaged lengths from asking for gigabytes.
constexpr int kMaxRowBytes = 1 << 28;

// A path as an SQLite URI, so that open parameters can be given.
std::string FileUri(const std::filesystem::path& file, const std::string& parameters) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : file.string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += {'%', kDigits[c / 16], kDigits[c % 16]};
    } else {
      uri += c;
    }
  }
  return uri + parameters;
}

}  // namespace

void Database::Closer::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
void Statement::Finalizer::operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }

Database::Database(const std::filesystem::path& name, const std::string& uri, int flags) : file_(name) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(uri.c_str(), &handle, flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) Fail(code);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMaxRowBytes);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

Database Database::OpenForReading(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw DataError(file.string() + ": is a folder");
  if (!std::filesystem::exists(file, error)) throw DataError(file.string() + ": no such file");
  Database database(file, FileUri(file, "?immutable=1"), SQLITE_OPEN_READONLY);
  database.Execute("PRAGMA cell_size_check = ON");
  return database;
}

Database Database::Create(const std::filesystem::path& temporary, const std::filesystem::path& target) {
  Database database(target, FileUri(temporary, ""), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  database.Execute(
      "PRAGMA page_size = 4096; PRAGMA encoding = 'UTF-8'; PRAGMA auto_vacuum = NONE; PRAGMA journal_mode = OFF;"
      "PRAGMA synchronous = OFF; PRAGMA locking_mode = EXCLUSIVE; PRAGMA cache_size = -16000;"
      "PRAGMA foreign_keys = ON");
  return database;
}

Database Database::InMemory() { return {":memory:", "file::memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE}; }

void Database::Fail(int code) const {
  const std::string reason = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_NOMEM:
      throw std::bad_alloc();
    case SQLITE_CONSTRAINT:
    case SQLITE_MISUSE:
    case SQLITE_RANGE:
      throw std::logic_error(file_.string() + ": breaks its own schema: " + reason);
    case SQLITE_NOTADB:
      throw DataError(file_.string() + ": not an SQLite file");
    case SQLITE_CANTOPEN:
      throw DataError(file_.string() + ": cannot be opened: " + reason);
    case SQLITE_FULL:
      throw DataError(file_.string() + ": could not be written: the disk is full");
    case SQLITE_IOERR:
      throw DataError(file_.string() + ": could not be read or written (disk full?): " + reason);
    default:
      throw DataError(file_.string() + ": damaged: " + reason);
  }
}

void Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) Fail(code);
}

Statement Database::Prepare(const std::string& sql) {
  sqlite3_stmt* handle = nullptr;
  const int code = sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &handle, nullptr);
  if (code != SQLITE_OK) Fail(code);
  return {this, handle};
}

std::int64_t Database::Integer(const std::string& sql) {
  Statement statement = Prepare(sql);
  if (!statement.Step()) throw DataError(file_.string() + ": damaged: no answer to " + sql);
  return statement.Integer(0);
}

void Statement::Check(int code) const {
  if (code != SQLITE_OK) database_->Fail(code);
}

void Statement::Bind(int parameter, std::int64_t value) { Check(sqlite3_bind_int64(handle_.get(), parameter, value)); }

void Statement::Bind(int parameter, double value) { Check(sqlite3_bind_double(handle_.get(), parameter, value)); }

void Statement::Bind(int parameter, std::string_view text) {
  Check(sqlite3_bind_text64(handle_.get(), parameter, text.data() ? text.data() : "", text.size(), SQLITE_TRANSIENT,
                            SQLITE_UTF8));
}

void Statement::Bind(int parameter, std::span<const std::byte> blob) {
  if (blob.empty()) {
    Check(sqlite3_bind_zeroblob(handle_.get(), parameter, 0));
  } else {
    Check(sqlite3_bind_blob64(handle_.get(), parameter, blob.data(), blob.size(), SQLITE_TRANSIENT));
  }
}

void Statement::BindNull(int parameter) { Check(sqlite3_bind_null(handle_.get(), parameter)); }

bool Statement::Step() {
  const int code = sqlite3_step(handle_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_->Fail(code);
  return code == SQLITE_ROW;
}

void Statement::Reset() { Check(sqlite3_reset(handle_.get())); }

int Statement::num_parameters() const { return sqlite3_bind_parameter_count(handle_.get()); }

int Statement::num_columns() const { return sqlite3_column_count(handle_.get()); }

std::string Statement::ColumnName(int column) const { return sqlite3_column_name(handle_.get(), column); }

ColumnType Statement::Type(int column) const {
  switch (sqlite3_column_type(handle_.get(), column)) {
    case SQLITE_INTEGER:
      return ColumnType::kInteger;
    case SQLITE_FLOAT:
      return ColumnType::kReal;
    case SQLITE_TEXT:
      return ColumnType::kText;
    case SQLITE_BLOB:
      return ColumnType::kBlob;
    default:
      return ColumnType::kNull;
  }
}

std::int64_t Statement::Integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }

double Statement::Real(int column) const { return sqlite3_column_double(handle_.get(), column); }

std::string_view Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
  return {text ? text : "", static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

std::span<const std::byte> Statement::Blob(int column) const {
  const auto* blob = static_cast<const std::byte*>(sqlite3_column_blob(handle_.get(), column));
  return {blob, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

}  // namespace formats
