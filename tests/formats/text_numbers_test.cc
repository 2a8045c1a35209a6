// SPDX-License-Identifier: Apache-2.0
#include "formats/text_numbers.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include "survey/stats/philox.h"

namespace formats {
namespace {

TEST(ParseStampTest, IsExact) {
  EXPECT_EQ(ParseStamp("976052858.404130"), 976052858404130000);
  EXPECT_EQ(ParseStamp("0.000000001"), 1);
  EXPECT_EQ(ParseStamp("-0.5"), -500'000'000);
  EXPECT_EQ(ParseStamp("12"), 12'000'000'000);
  EXPECT_EQ(ParseStamp("12."), 12'000'000'000);
  EXPECT_EQ(ParseStamp(".25"), 250'000'000);
  EXPECT_EQ(ParseStamp("+1"), 1'000'000'000);
  EXPECT_EQ(ParseStamp("1232663298.3212851"), 1232663298321285100);
}

TEST(ParseStampTest, ReadsExponents) {
  EXPECT_EQ(ParseStamp("1.232663298321285e+09"), 1232663298321285000);
  EXPECT_EQ(ParseStamp("5e-9"), 5);
  EXPECT_EQ(ParseStamp("1e3"), 1'000'000'000'000);
  EXPECT_EQ(ParseStamp("0e30"), 0);
}

TEST(ParseStampTest, RoundsBelowANanosecond) {
  EXPECT_EQ(ParseStamp("0.30000000000000004"), 300'000'000);
  EXPECT_EQ(ParseStamp("0.0000000015"), 2);
  EXPECT_EQ(ParseStamp("0.00000000149"), 1);
  EXPECT_EQ(ParseStamp("1e-12"), 0);
}

TEST(ParseStampTest, RefusesWhatIsNoStamp) {
  for (const char* text : {"", ".", "-", "1.2.3", "1 2", "nan", "inf", "1e", "1e99", "0x1", "1,5", "99999999999", "e5"})
    EXPECT_EQ(ParseStamp(text), std::nullopt) << text;
}

TEST(StampTextTest, ReadsBack) {
  EXPECT_EQ(StampText(976052858404130000), "976052858.40413");
  EXPECT_EQ(StampText(0), "0.0");
  EXPECT_EQ(StampText(-500'000'000), "-0.5");
  EXPECT_EQ(StampText(1), "0.000000001");
  EXPECT_EQ(StampText(100'000'000'000), "100.0");
}

TEST(ParseNumberTest, RefusesAnythingButAFiniteNumber) {
  EXPECT_EQ(ParseNumber("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(ParseNumber("+2"), 2.0);
  for (const char* text : {"", "nan", "inf", "-inf", "1e999", "1,5", "2x", " 1", "+-1", "0x10"})
    EXPECT_EQ(ParseNumber(text), std::nullopt) << text;
  EXPECT_EQ(WhyNotANumber("1,5"), "decimal comma: write numbers with a decimal point");
  EXPECT_EQ(WhyNotANumber("-inf"), "must be a finite number");
  EXPECT_EQ(WhyNotANumber("abc"), "is not a number");
}

// The plain form against the library's own conversion, to the last bit.
template <typename T>
void ExpectPlainNumbersExact(int most_digits) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const survey::RandomStream random(3, 1, i);
    const auto digits = static_cast<int>(random.Uniform(0, 1, most_digits + 3));
    std::string text = random.Uniform(1) < 0.3 ? "-" : "";
    const auto point = static_cast<int>(random.Uniform(2, 1, digits + 2));
    for (int k = 0; k < digits; ++k) {
      if (k == point) text += '.';
      text += static_cast<char>('0' + static_cast<int>(random.Uniform(static_cast<std::uint64_t>(10 + k), 0, 10)));
    }
    T expected{};
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), expected);
    ASSERT_TRUE(error == std::errc() && stop == text.data() + text.size()) << text;
    T value{};
    const char* const end = ScanPlainNumber(text.data(), text.data() + text.size(), &value);
    if (digits > most_digits) {
      EXPECT_EQ(end, nullptr) << text;
      continue;
    }
    ASSERT_EQ(end, text.data() + text.size()) << text;
    EXPECT_EQ(std::memcmp(&value, &expected, sizeof value), 0) << text << " " << value << " " << expected;
  }
}

TEST(TextNumbers, PlainNumbersAreExact) {
  ExpectPlainNumbersExact<float>(7);
  ExpectPlainNumbersExact<double>(15);
}

TEST(TextNumbers, PlainNumbersEndWhereTheyEnd) {
  const auto length = [](std::string_view text) -> std::ptrdiff_t {
    float value = 0.0F;
    const char* const end = ScanPlainNumber(text.data(), text.data() + text.size(), &value);
    return end == nullptr ? -1 : end - text.data();
  };
  EXPECT_EQ(length("4.9,3"), 3);
  EXPECT_EQ(length("4.,3"), 2);
  EXPECT_EQ(length("12m"), 2);  // what follows is for the caller to judge
  for (const char* text : {"", "-", ".", ".5", "+1", " 1", "1e3", "1.5E1", "1.2.3", "nan", "12345678", "1.2345678"})
    EXPECT_EQ(length(text), -1) << text;
}

}  // namespace
}  // namespace formats
