// SPDX-License-Identifier: Apache-2.0
//
// JSON from and to text and files. Kept to one source: parser and serializer are compiled anew wherever they are named.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace formats {

// nlohmann::json::exception when the text is not JSON.
nlohmann::json ParsedJson(std::string_view text);

// A discarded value (no object, no array) when the text is not JSON, as when a file was cut off.
nlohmann::json JsonOrDiscarded(std::string_view text);

std::string JsonText(const nlohmann::json& document);  // in one line

// Lines indented by one blank a level, atomically.
void WriteJson(const std::filesystem::path& file, const nlohmann::json& document);

}  // namespace formats
