// SPDX-License-Identifier: Apache-2.0
#include "formats/text_encoding.h"

#include <fstream>
#include <vector>

#include "formats/errors.h"

namespace formats {
namespace {

// Length of the UTF-8 sequence that a byte leads; 0: none.
std::size_t SequenceLength(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead < 0xC2) return 0;
  if (lead < 0xE0) return 2;
  if (lead < 0xF0) return 3;
  return lead < 0xF5 ? 4 : 0;
}

// Bytes of whole, valid sequences at the start.
std::size_t ValidPrefix(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const std::size_t length = SequenceLength(static_cast<unsigned char>(text[i]));
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) >> 6U) != 2) return i;
    }
    i += length;
  }
  return i;
}

}  // namespace

bool IsUtf8(std::string_view text) { return ValidPrefix(text) == text.size(); }

std::string Utf8OfLatin1(std::string_view text) {
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0U | (byte >> 6U));
      utf8 += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return utf8;
}

bool FileIsUtf8(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw DataError(file.string() + ": cannot be read");
  std::vector<char> block(std::size_t{1} << 20);
  std::size_t kept = 0;  // of a sequence that the block's end cuts
  while (in) {
    in.read(block.data() + kept, static_cast<std::streamsize>(block.size() - kept));
    const std::string_view text(block.data(), kept + static_cast<std::size_t>(in.gcount()));
    const std::size_t valid = ValidPrefix(text);
    if (text.size() - valid > 3) return false;
    kept = text.copy(block.data(), text.size() - valid, valid);
  }
  return kept == 0;
}

}  // namespace formats
