// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace test_support {

// Checks a document against the part of JSON Schema (2020-12) that our schemas use: type, enum, const, properties,
// required, additionalProperties (false), items, anyOf and $ref to "#/$defs/...". Says where and what, or nothing.
std::string SchemaViolation(const nlohmann::json& schema, const nlohmann::json& document);

}  // namespace test_support
