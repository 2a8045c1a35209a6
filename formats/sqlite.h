// SPDX-License-Identifier: Apache-2.0
//
// A thin owner of SQLite's handles. Every failure is a DataError that names the file; sqlite3.h stays in the .cc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace formats {

enum class ColumnType { kInteger, kReal, kText, kBlob, kNull };

class Statement;

class Database {
 public:
  // Opens for reading. The file is taken as immutable: no locks, no journal, nothing written beside it.
  static Database OpenForReading(const std::filesystem::path& file);

  // Makes a new database at `temporary` that nobody else sees before it is renamed to `target`: without journal and
  // without syncing. Errors name `target`.
  static Database Create(const std::filesystem::path& temporary, const std::filesystem::path& target);

  static Database InMemory();

  void Execute(const std::string& sql);
  Statement Prepare(const std::string& sql);
  std::int64_t Integer(const std::string& sql);  // the one value that `sql` returns

  // Throws DataError for SQLite's result code: damaged, not a database, disk full, ...
  [[noreturn]] void Fail(int code) const;
  const std::filesystem::path& file() const { return file_; }

 private:
  struct Closer {
    void operator()(sqlite3* handle) const;
  };
  Database(const std::filesystem::path& name, const std::string& uri, int flags);

  std::filesystem::path file_;  // as named in messages
  std::unique_ptr<sqlite3, Closer> handle_;
};

// A prepared statement. Must not outlive its database. Parameters count from 1, columns from 0.
class Statement {
 public:
  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);  // NaN becomes NULL
  void Bind(int parameter, std::string_view text);
  void Bind(int parameter, std::span<const std::byte> blob);
  void BindNull(int parameter);

  bool Step();  // true: a row is there
  void Reset();

  int num_parameters() const;
  int num_columns() const;
  std::string ColumnName(int column) const;
  ColumnType Type(int column) const;
  // Views live until the next Step or Reset.
  std::int64_t Integer(int column) const;
  double Real(int column) const;
  std::string_view Text(int column) const;
  std::span<const std::byte> Blob(int column) const;

 private:
  friend class Database;
  struct Finalizer {
    void operator()(sqlite3_stmt* handle) const;
  };
  Statement(const Database* database, sqlite3_stmt* handle) : database_(database), handle_(handle) {}
  void Check(int code) const;

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> handle_;
};

}  // namespace formats
