// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_section.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {

toml::table ParseTomlFile(const std::filesystem::path& file) {
  const std::string text = ReadWholeFile(file);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    std::ostringstream where;
    where << file.string() << ":" << error.source().begin.line << ": " << error.description();
    throw DataError(where.str());
  }
}

void TomlSection::Fail(const toml::node* node, const std::string& what) const {
  const auto line = node == nullptr ? 0 : node->source().begin.line;
  throw DataError(file_.string() + (line > 0 ? ":" + std::to_string(line) : std::string()) + ": " +
                  (name_.empty() ? "" : name_ + ": ") + what);
}

const toml::node* TomlSection::Find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

const toml::node& TomlSection::Require(const std::string& key) {
  const toml::node* node = Find(key);
  if (node == nullptr) Fail(key + " is missing");
  return *node;
}

void TomlSection::Number(const std::string& key, double* value, Limits limits, double unit) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const auto number = node->is_number() ? node->value<double>() : std::nullopt;
  if (!number || !std::isfinite(*number)) Fail(node, key + ": must be a number");
  if (*number < limits.min)
    Fail(node, key + " = " + NumberText(*number) + ": must be at least " + NumberText(limits.min));
  if (*number > limits.max)
    Fail(node, key + " = " + NumberText(*number) + ": must be at most " + NumberText(limits.max));
  *value = *number * unit;
}

void TomlSection::Integer(const std::string& key, int* value, Limits limits) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  if (!node->is_integer()) Fail(node, key + ": must be an integer");
  double number = 0.0;
  Number(key, &number, limits);
  *value = static_cast<int>(number);
}

void TomlSection::Bool(const std::string& key, bool* value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) Fail(node, key + ": must be true or false");
  *value = *node->value<bool>();
}

void TomlSection::Text(const std::string& key, std::string* value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  if (!node->is_string()) Fail(node, key + ": must be a text in quotes");
  *value = *node->value<std::string>();
}

void TomlSection::Word(const std::string& key, std::string* value, const std::vector<std::string>& allowed) {
  Text(key, value);
  if (!Has(key) || std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return;
  std::string list;
  for (const std::string& word : allowed) list += (list.empty() ? "" : ", ") + word;
  Fail(table_.get(key), key + " = \"" + *value + "\": must be one of " + list);
}

void TomlSection::Numbers(const std::string& key, std::vector<double>* values, std::size_t count) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) Fail(node, key + ": must be " + std::to_string(count) + " numbers");
  values->clear();
  for (const toml::node& element : *array) {
    const auto number = element.is_number() ? element.value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) Fail(&element, key + ": must be " + std::to_string(count) + " numbers");
    values->push_back(*number);
  }
}

Eigen::Vector2d TomlSection::PointOf(const toml::node& node, const std::string& key) const {
  const toml::array* array = node.as_array();
  if (array != nullptr && array->size() == 2 && (*array)[0].is_number() && (*array)[1].is_number()) {
    Eigen::Vector2d point(*(*array)[0].value<double>(), *(*array)[1].value<double>());
    if (point.allFinite()) return point;
  }
  Fail(&node, key + ": must be a point [x, y]");
}

void TomlSection::Point(const std::string& key, Eigen::Vector2d* value) {
  const toml::node* node = Find(key);
  if (node != nullptr) *value = PointOf(*node, key);
}

void TomlSection::Line(const std::string& key, std::vector<Eigen::Vector2d>* line, std::size_t min_points) {
  const toml::array* array = Array(key);
  if (array == nullptr) return;
  line->clear();
  for (const toml::node& node : *array) {
    line->push_back(PointOf(node, key));
    if (line->size() > 1 && ((*line)[line->size() - 2] - line->back()).norm() < 1e-6)
      Fail(&node, key + ": the same point twice in a row");
  }
  if (line->size() < min_points) Fail(array, key + ": needs at least " + std::to_string(min_points) + " points");
}

void TomlSection::Texts(const std::string& key, std::vector<std::string>* values) {
  const toml::array* array = Array(key);
  if (array == nullptr) return;
  values->clear();
  for (const toml::node& node : *array) {
    if (!node.is_string()) Fail(&node, key + ": must be texts in quotes");
    values->push_back(*node.value<std::string>());
  }
}

std::string TomlSection::RequiredText(const std::string& key) {
  std::string value;
  Text(key, &value);
  if (value.empty()) Fail(&Require(key), key + ": must not be empty");
  return value;
}

Eigen::Vector2d TomlSection::RequiredPoint(const std::string& key) { return PointOf(Require(key), key); }

std::vector<Eigen::Vector2d> TomlSection::RequiredLine(const std::string& key, std::size_t min_points) {
  Require(key);
  std::vector<Eigen::Vector2d> line;
  Line(key, &line, min_points);
  return line;
}

TomlSection TomlSection::Table(const std::string& key) {
  static const toml::table kEmpty;
  const toml::node* node = Find(key);
  if (node == nullptr) return {kEmpty, file_, key};
  if (!node->is_table()) Fail(node, key + ": must be a table");
  return {*node->as_table(), file_, key};
}

std::vector<TomlSection> TomlSection::Tables(const std::string& key) {
  std::vector<TomlSection> sections;
  const toml::array* array = Array(key);
  if (array == nullptr) return sections;
  for (const toml::node& node : *array) {
    if (!node.is_table()) Fail(&node, key + ": must be tables");
    sections.emplace_back(*node.as_table(), file_, key + " " + std::to_string(sections.size() + 1));
  }
  return sections;
}

const toml::array* TomlSection::Array(const std::string& key) {
  const toml::node* node = Find(key);
  if (node == nullptr) return nullptr;
  if (!node->is_array()) Fail(node, key + ": must be an array");
  return node->as_array();
}

void TomlSection::Finish() const {
  for (const auto& [key, node] : table_) {
    if (known_.contains(std::string(key.str()))) continue;
    std::string list;
    for (const std::string& word : known_) list += (list.empty() ? "" : ", ") + word;
    Fail(&node, std::string(key.str()) + ": unknown key; known are " + list);
  }
}

}  // namespace formats
