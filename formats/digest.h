// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace formats {

// Lower-case hexadecimal SHA-256.
std::string Sha256(std::string_view bytes);
std::string Sha256OfFile(const std::filesystem::path& file);  // streamed; DataError when unreadable

// SHA-256 of a text file without blank lines, '#' comments (whole lines), byte-order mark and trailing white space, so
// that a comment does not count as a change.
std::string Sha256OfTextWithoutComments(const std::filesystem::path& file);

// CRC-32 (ISO 3309, as zlib's crc32) of a blob that follows bytes with the CRC-32 `previous`.
std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t previous = 0);

// That of bytes with the CRC-32 `first` and `second_size` bytes with the CRC-32 `second` after them.
std::uint32_t CombinedCrc32(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

}  // namespace formats
