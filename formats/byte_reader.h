// SPDX-License-Identifier: Apache-2.0
//
// Little-endian binary data, read with its bounds checked.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace formats {

static_assert(std::endian::native == std::endian::little, "binary files are read as they lie in memory");

class ByteReader {
 public:
  // What is read past the end of.
  struct EndOfData : std::runtime_error {
    EndOfData() : std::runtime_error("data ends early") {}
  };

  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  bool empty() const { return rest_.empty(); }
  std::size_t size() const { return rest_.size(); }

  std::string_view Bytes(std::size_t count) {
    if (count > rest_.size()) throw EndOfData();
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }

  template <typename T>
  T Read() {
    static_assert(std::is_arithmetic_v<T>);
    T value;
    std::memcpy(&value, Bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }

  // Bytes after their 32-bit length.
  std::string_view Sized() { return Bytes(Read<std::uint32_t>()); }

 private:
  std::string_view rest_;
};

}  // namespace formats
