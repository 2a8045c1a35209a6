// SPDX-License-Identifier: Apache-2.0
//
// Texts that come in an older encoding than UTF-8.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace formats {

bool IsUtf8(std::string_view text);
std::string Utf8OfLatin1(std::string_view text);

// Of a file of any size, without holding it. DataError when it cannot be read.
bool FileIsUtf8(const std::filesystem::path& file);

}  // namespace formats
