// SPDX-License-Identifier: Apache-2.0
#include "formats/json_text.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"

namespace formats {

using nlohmann::json;

json ParsedJson(std::string_view text) { return json::parse(text); }

json JsonOrDiscarded(std::string_view text) { return json::parse(text, nullptr, false); }

std::string JsonText(const json& document) { return document.dump(); }

void WriteJson(const std::filesystem::path& file, const json& document) {
  WriteFileAtomically(file, document.dump(1) + "\n");
}

}  // namespace formats
