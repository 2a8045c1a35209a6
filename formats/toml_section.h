// SPDX-License-Identifier: Apache-2.0
//
// Strict reading of a TOML table: every value is checked for type and range, and keys that nobody asked for are errors.
// DataError names file, line, key, value and rule.
#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace formats {

toml::table ParseTomlFile(const std::filesystem::path& file);

class TomlSection {
 public:
  struct Limits {
    double min = std::numeric_limits<double>::lowest();
    double max = std::numeric_limits<double>::max();
  };

  // `name` is how messages call the table: "lidar", "wall 3". Both references must outlive the section.
  TomlSection(const toml::table& table, std::filesystem::path file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  bool Has(const std::string& key) const { return table_.contains(key); }

  // Values that may be left out keep what is there.
  void Number(const std::string& key, double* value, Limits limits, double unit = 1.0);
  void Integer(const std::string& key, int* value, Limits limits);
  void Bool(const std::string& key, bool* value);
  void Text(const std::string& key, std::string* value);
  void Word(const std::string& key, std::string* value, const std::vector<std::string>& allowed);
  void Numbers(const std::string& key, std::vector<double>* values, std::size_t count);
  void Point(const std::string& key, Eigen::Vector2d* value);
  void Line(const std::string& key, std::vector<Eigen::Vector2d>* line, std::size_t min_points);
  void Texts(const std::string& key, std::vector<std::string>* values);

  // The same for keys that must be there.
  std::string RequiredText(const std::string& key);
  Eigen::Vector2d RequiredPoint(const std::string& key);
  std::vector<Eigen::Vector2d> RequiredLine(const std::string& key, std::size_t min_points);

  // Sub-tables. A missing table is an empty one; a missing array has no elements.
  TomlSection Table(const std::string& key);
  std::vector<TomlSection> Tables(const std::string& key);
  const toml::array* Array(const std::string& key);

  Eigen::Vector2d PointOf(const toml::node& node, const std::string& key) const;

  // Call when all keys were asked for: DataError for any other key.
  void Finish() const;

  [[noreturn]] void Fail(const toml::node* node, const std::string& what) const;
  [[noreturn]] void Fail(const std::string& what) const { Fail(&table_, what); }

 private:
  const toml::node* Find(const std::string& key);
  const toml::node& Require(const std::string& key);

  const toml::table& table_;
  std::filesystem::path file_;
  std::string name_;
  std::set<std::string> known_;
};

}  // namespace formats
