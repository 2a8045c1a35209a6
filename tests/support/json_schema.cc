// SPDX-License-Identifier: Apache-2.0
#include "tests/support/json_schema.h"

#include <algorithm>
#include <set>

namespace test_support {
namespace {

using nlohmann::json;

class Validator {
 public:
  explicit Validator(const json& root) : root_(root) {}

  std::string Check(const json& schema, const json& value, const std::string& where) const {
    static const std::set<std::string> kKnown = {
        "type",  "enum",  "const",       "properties", "required", "$ref", "additionalProperties",
        "items", "anyOf", "description", "title",      "$schema",  "$id",  "$defs"};
    for (const auto& [key, unused] : schema.items()) {
      if (!kKnown.contains(key)) return where + ": this validator does not know \"" + key + "\"";
    }
    if (schema.contains("$ref")) {
      const std::string pointer = schema["$ref"].get<std::string>().substr(1);
      return Check(root_.at(json::json_pointer(pointer)), value, where);
    }
    if (schema.contains("type") && !HasType(schema["type"], value)) {
      return where + ": is " + value.type_name() + ", not " + schema["type"].dump();
    }
    if (schema.contains("const") && value != schema["const"]) return where + ": is not " + schema["const"].dump();
    if (schema.contains("enum") &&
        std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end()) {
      return where + ": is none of " + schema["enum"].dump();
    }
    if (schema.contains("anyOf") && std::none_of(schema["anyOf"].begin(), schema["anyOf"].end(),
                                                 [&](const json& each) { return Check(each, value, where).empty(); })) {
      return where + ": fits no alternative";
    }
    if (value.is_object()) return CheckMembers(schema, value, where);
    if (value.is_array() && schema.contains("items")) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string violation = Check(schema["items"], value[i], where + "/" + std::to_string(i));
        if (!violation.empty()) return violation;
      }
    }
    return "";
  }

 private:
  static bool HasType(const json& type, const json& value) {
    if (type.is_array()) {
      return std::any_of(type.begin(), type.end(), [&](const json& each) { return HasType(each, value); });
    }
    const std::string name = type.get<std::string>();
    if (name == "integer") return value.is_number_integer();
    return name == value.type_name();  // object, array, string, number, boolean, null
  }

  std::string CheckMembers(const json& schema, const json& value, const std::string& where) const {
    for (const json& needed : schema.value("required", json::array())) {
      if (!value.contains(needed.get<std::string>())) return where + ": lacks " + needed.dump();
    }
    const json properties = schema.value("properties", json::object());
    for (const auto& [key, member] : value.items()) {
      if (properties.contains(key)) {
        const std::string violation = Check(properties[key], member, where + "/" + key);
        if (!violation.empty()) return violation;
      } else if (schema.contains("additionalProperties") && schema["additionalProperties"] == false) {
        return where + ": \"" + key + "\" is not foreseen";
      }
    }
    return "";
  }

  const json& root_;
};

}  // namespace

std::string SchemaViolation(const json& schema, const json& document) {
  return Validator(schema).Check(schema, document, "");
}

}  // namespace test_support
