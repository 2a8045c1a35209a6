// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace survey {
namespace {

// Tables found in any statistics textbook.
TEST(DistributionsTest, AgreeWithTables) {
  EXPECT_NEAR(NormalCdf(1.959964), 0.975, 1e-7);
  EXPECT_NEAR(ChiSquareQuantile(0.05, 10), 3.940, 5e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.975, 30), 46.979, 5e-4);
  EXPECT_NEAR(ChiSquareUpperTail(13.816, 2), 0.001, 1e-6);
  EXPECT_NEAR(FisherUpperTail(4.103, 2, 10), 0.05, 1e-4);
}

// With two degrees of freedom the chi-square distribution is exponential: a second method.
TEST(DistributionsTest, ChiSquareOfTwoIsExponential) {
  for (const double p : {0.001, 0.3, 0.95, 0.9999}) EXPECT_NEAR(ChiSquareQuantile(p, 2), -2 * std::log1p(-p), 1e-9);
}

// Without an effect the power is the level; as the second degrees of freedom grow it becomes that of chi-square.
TEST(DistributionsTest, NonCentralFisher) {
  const double critical = FisherQuantile(0.95, 2, 30);
  EXPECT_NEAR(critical, 3.3158, 5e-5);
  EXPECT_NEAR(NonCentralFisherUpperTail(critical, 2, 30, 0.0), 0.05, 1e-9);
  // Non-central chi-square of 2 degrees: a Poisson mixture of central ones.
  double expected = 0.0;
  double weight = std::exp(-2.0);
  for (int k = 0; k < 60; ++k) {
    expected += weight * ChiSquareUpperTail(5.991, 2.0 + 2.0 * k);
    weight *= 2.0 / (k + 1);
  }
  EXPECT_NEAR(NonCentralFisherUpperTail(5.991 / 2, 2, 1e7, 4.0), expected, 1e-5);
}

TEST(DistributionsTest, LargestRate) {
  EXPECT_LT(LargestRate(0, 59, 0.95), 0.05);  // 59 without a hit demonstrate 95 %
  EXPECT_GT(LargestRate(0, 58, 0.95), 0.05);
  EXPECT_NEAR(LargestRate(1, 20, 0.95), 0.216, 5e-4);
  EXPECT_NEAR(LargestRate(0, 1, 0.95), 0.95, 1e-12);
  EXPECT_EQ(LargestRate(3, 3, 0.95), 1.0);
}

}  // namespace
}  // namespace survey
