// SPDX-License-Identifier: Apache-2.0
//
// Counter-based random numbers, Philox4x32-10 of [Salmon11]: the number with a given index is a function of (seed,
// purpose, stream, index) alone. So results do not depend on the order or the thread in which numbers are drawn, and
// drawing more numbers for one purpose never reshuffles another. Normal numbers by Box-Muller, not by the standard
// library, whose distributions differ between implementations.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>

namespace survey {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

inline PhiloxCounter Philox4x32(PhiloxCounter counter, PhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53U} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57U} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

// 32-bit FNV-1a hash of a name, for streams that belong to something named (a block, a row of cars).
constexpr std::uint32_t StreamOfName(std::string_view name) {
  std::uint32_t hash = 2166136261U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

// The numbers of one purpose (an enumerator of the caller's) and one stream (a block, a particle).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint32_t purpose, std::uint32_t stream)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        purpose_(purpose),
        stream_(stream) {}

  std::array<std::uint32_t, 4> Bits(std::uint64_t index) const {
    return Philox4x32({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), stream_, purpose_},
                      key_);
  }

  // Two independent numbers, uniform in [0, 1) with 53 bits.
  std::pair<double, double> Uniforms(std::uint64_t index) const {
    const std::array<std::uint32_t, 4> bits = Bits(index);
    return {ToUniform(bits[0], bits[1]), ToUniform(bits[2], bits[3])};
  }
  double Uniform(std::uint64_t index) const { return Uniforms(index).first; }
  double Uniform(std::uint64_t index, double low, double high) const { return low + (high - low) * Uniform(index); }

  // Two independent standard normal numbers.
  std::pair<double, double> Normals(std::uint64_t index) const {
    const auto [u, v] = Uniforms(index);
    const double radius = std::sqrt(-2.0 * std::log1p(-u));  // 1 - u lies in (0, 1]
    const double angle = 2.0 * std::numbers::pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }
  double Normal(std::uint64_t index) const { return Normals(index).first; }

 private:
  static double ToUniform(std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t{high} << 21) ^ (low >> 11);
    return static_cast<double>(bits) * 0x1p-53;
  }

  PhiloxKey key_;
  std::uint32_t purpose_;
  std::uint32_t stream_;
};

}  // namespace survey
