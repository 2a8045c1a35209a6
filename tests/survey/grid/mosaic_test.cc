// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/mosaic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace survey {
namespace {

SiteRaster Row(std::int64_t min_column, std::int64_t min_row, std::vector<float> values) {
  return {.cell_size_m = 0.1,
          .min_column = min_column,
          .min_row = min_row,
          .width = static_cast<int>(values.size()),
          .height = 1,
          .log_odds = std::move(values)};
}

TEST(Mosaic, AddsTheEvidenceCellByCellAndClampsTheSum) {
  const SiteRaster a = Row(-2, 5, {1.0F, -1.5F, kUnknownLogOdds, 3.0F});
  const SiteRaster b = Row(-1, 5, {-1.0F, kUnknownLogOdds, 3.0F, 0.5F});
  const std::array<const SiteRaster*, 2> blocks = {&a, &b};
  const SiteRaster site = Mosaic(blocks, {.min_log_odds = -2, .max_log_odds = 4});
  EXPECT_EQ(site.min_column, -2);
  EXPECT_EQ(site.min_row, 5);
  ASSERT_EQ(site.width, 5);
  ASSERT_EQ(site.height, 1);
  EXPECT_FLOAT_EQ(site.At(0, 0), 1.0F);
  EXPECT_FLOAT_EQ(site.At(1, 0), -2.0F);  // -2.5
  EXPECT_TRUE(std::isnan(site.At(2, 0)));
  EXPECT_FLOAT_EQ(site.At(3, 0), 4.0F);  // 6
  EXPECT_FLOAT_EQ(site.At(4, 0), 0.5F);
}

TEST(Mosaic, CoversBlocksThatLieApart) {
  const SiteRaster a = Row(0, 0, {1.0F});
  const SiteRaster b = Row(3, 2, {-1.0F});
  const std::array<const SiteRaster*, 2> blocks = {&a, &b};
  const SiteRaster site = Mosaic(blocks, {});
  ASSERT_EQ(site.width, 4);
  ASSERT_EQ(site.height, 3);
  EXPECT_FLOAT_EQ(site.At(0, 0), 1.0F);
  EXPECT_FLOAT_EQ(site.At(3, 2), -1.0F);
  EXPECT_TRUE(std::isnan(site.At(3, 0)));
}

TEST(Mosaic, StripsAreTheRowsOfTheWhole) {
  SiteRaster a{.cell_size_m = 0.1, .min_column = 0, .min_row = -3, .width = 3, .height = 7, .log_odds = {}};
  for (int i = 0; i < a.width * a.height; ++i)
    a.log_odds.push_back(i % 4 == 0 ? kUnknownLogOdds : 0.1F * static_cast<float>(i));
  SiteRaster b = a;
  b.min_column = 2;
  b.min_row = 1;
  const SiteRaster whole = Mosaic(std::array<const SiteRaster*, 2>{&a, &b}, {});
  const RasterStrips strips = MosaicOf({StripsOf(a), StripsOf(b)}, {});
  EXPECT_TRUE(strips.frame.log_odds.empty());
  for (std::int64_t first = whole.min_row; first < whole.min_row + whole.height; first += 2) {
    const int height = static_cast<int>(std::min<std::int64_t>(2, whole.min_row + whole.height - first));
    const SiteRaster rows = strips.read(first, height);
    ASSERT_EQ(rows.width, whole.width);
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < whole.width; ++column) {
        const float expected = whole.At(column, row + static_cast<int>(first - whole.min_row));
        if (std::isnan(expected)) {
          EXPECT_TRUE(std::isnan(rows.At(column, row)));
        } else {
          EXPECT_EQ(rows.At(column, row), expected);
        }
      }
    }
  }
}

TEST(Mosaic, TakesTheLargestSigmaOfTheBlocksThatSawACell) {
  SiteRaster a = Row(0, 0, {1.0F, 1.0F, kUnknownLogOdds});
  SiteRaster b = Row(1, 0, {1.0F, 1.0F});
  a.sigma_m = {0.01F, 0.02F, std::numeric_limits<float>::quiet_NaN()};
  const std::array<const SiteRaster*, 2> blocks = {&a, &b};
  EXPECT_TRUE(Mosaic(blocks, {}).sigma_m.empty());
  b.sigma_m = {0.005F, 0.03F};
  EXPECT_EQ(Mosaic(blocks, {}).sigma_m, (std::vector<float>{0.01F, 0.02F, 0.03F}));
}

TEST(Mosaic, OfOneBlockIsTheBlock) {
  const SiteRaster a = Row(7, -3, {1.0F, kUnknownLogOdds, -1.0F});
  const std::array<const SiteRaster*, 1> blocks = {&a};
  const SiteRaster site = Mosaic(blocks, {});
  EXPECT_EQ(site.min_column, 7);
  EXPECT_EQ(site.min_row, -3);
  EXPECT_EQ(site.width, 3);
  EXPECT_FLOAT_EQ(site.At(2, 0), -1.0F);
}

}  // namespace
}  // namespace survey
