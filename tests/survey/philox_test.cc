// SPDX-License-Identifier: Apache-2.0
#include "survey/stats/philox.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

// The known answers published with the authors' Random123 library (kat_vectors, philox4x32 10).
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(Philox4x32({0, 0, 0, 0}, {0, 0}), (PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, StreamsAndPurposesDiffer) {
  const RandomStream a(7, 1, 1);
  EXPECT_EQ(a.Bits(5), RandomStream(7, 1, 1).Bits(5));
  EXPECT_NE(a.Bits(5), a.Bits(6));
  EXPECT_NE(a.Bits(5), RandomStream(7, 1, 2).Bits(5));
  EXPECT_NE(a.Bits(5), RandomStream(7, 2, 1).Bits(5));
  EXPECT_NE(a.Bits(5), RandomStream(8, 1, 1).Bits(5));
  EXPECT_NE(a.Bits(5), RandomStream(7ULL + (1ULL << 40), 1, 1).Bits(5));
}

// Moments of a million numbers; tolerances are five standard errors.
TEST(Philox, UniformAndNormalMoments) {
  const RandomStream random(2026, 3, 4);
  const int n = 500000;
  double uniform_sum = 0;
  double sum = 0;
  double squares = 0;
  double fourth = 0;
  double cross = 0;
  int beyond_two = 0;
  for (int i = 0; i < n; ++i) {
    const double u = random.Uniform(static_cast<std::uint64_t>(i));
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    uniform_sum += u;
    const auto [x, y] = random.Normals(static_cast<std::uint64_t>(i));
    sum += x + y;
    squares += x * x + y * y;
    fourth += x * x * x * x + y * y * y * y;
    cross += x * y;
    beyond_two += (std::abs(x) > 2.0) + (std::abs(y) > 2.0);
  }
  const double m = 2.0 * n;
  EXPECT_NEAR(uniform_sum / n, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(sum / m, 0.0, 5.0 / std::sqrt(m));
  EXPECT_NEAR(squares / m, 1.0, 5.0 * std::sqrt(2.0 / m));
  EXPECT_NEAR(fourth / m, 3.0, 5.0 * std::sqrt(96.0 / m));
  EXPECT_NEAR(cross / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(beyond_two / m, 0.0455003, 5.0 * std::sqrt(0.0455 / m));
}

}  // namespace
}  // namespace survey
