// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/clock_repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace survey {
namespace {

constexpr StampNs kSecond = 1'000'000'000;

// A stamp as the faulty program prints it: seconds, a point, the microseconds without leading zeros, padded at the end.
StampNs PrintedUnpadded(StampNs stamp) {
  const StampNs us = stamp % kSecond / 1000;
  std::string digits = std::to_string(us);
  digits.resize(6, '0');
  return stamp / kSecond * kSecond + std::stoll(digits) * 1000;
}

std::vector<StampNs> TrueStamps(std::size_t count) {
  std::vector<StampNs> stamps;
  for (std::size_t i = 0; i < count; ++i) {
    // Steps of 30 to 50 ms at microsecond resolution.
    const auto step = 30'000 + static_cast<StampNs>(20'000 * std::abs(std::sin(static_cast<double>(i * i))));
    stamps.push_back((i == 0 ? 976'052'857 * kSecond + 337'284'000 : stamps.back()) + step * 1000);
  }
  return stamps;
}

TEST(ClockRepairTest, RecoversStampsPrintedWithoutLeadingZeros) {
  const std::vector<StampNs> truth = TrueStamps(5000);
  std::vector<StampNs> printed;
  std::size_t wrong = 0;
  for (const StampNs stamp : truth) {
    printed.push_back(PrintedUnpadded(stamp));
    wrong += printed.back() != stamp ? 1 : 0;
  }
  EXPECT_GT(wrong, 400U);  // a tenth of them
  const std::vector<StampNs> repair = RepairUnpaddedMicroseconds(printed);
  ASSERT_EQ(repair.size(), truth.size());
  // A stamp that ends in zeros may have been several, all of them in order: off by less than a step, and rarely.
  std::size_t off = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT(std::abs(printed[i] + repair[i] - truth[i]), 30'000'000) << i;
    off += printed[i] + repair[i] != truth[i] ? 1 : 0;
  }
  EXPECT_LE(off, 5U);
}

TEST(ClockRepairTest, LeavesASoundLogAlone) { EXPECT_TRUE(RepairUnpaddedMicroseconds(TrueStamps(5000)).empty()); }

TEST(ClockRepairTest, LeavesOtherDisorderAlone) {
  std::vector<StampNs> stamps = TrueStamps(1000);
  std::swap(stamps[100], stamps[120]);
  EXPECT_TRUE(RepairUnpaddedMicroseconds(stamps).empty());
  // Stamps of tenths of a second that go back: no digits to judge by.
  std::vector<StampNs> coarse;
  for (StampNs i = 0; i < 1000; ++i) coarse.push_back(i * kSecond + (i % 9 + 1) * kSecond / 10);
  std::swap(coarse[500], coarse[510]);
  EXPECT_TRUE(RepairUnpaddedMicroseconds(coarse).empty());
}

TEST(ClockRepairTest, NeedsEnoughStampsToTell) {
  std::vector<StampNs> printed;
  for (const StampNs stamp : TrueStamps(100)) printed.push_back(PrintedUnpadded(stamp));
  EXPECT_TRUE(RepairUnpaddedMicroseconds(printed).empty());
  EXPECT_TRUE(RepairUnpaddedMicroseconds({}).empty());
}

}  // namespace
}  // namespace survey
