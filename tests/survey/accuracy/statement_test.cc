// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/statement.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

bool Has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(StatementTest, WordingFollowsTheNumberOfPoints) {
  const std::string many = AsprsStatement({30, 0.05, 0.0314, 0.054});
  EXPECT_EQ(many,
            "This data set was tested to meet ASPRS Positional Accuracy Standards for Digital Geospatial Data, Edition "
            "2, Version 2 (2024) for a 5.0 (cm) RMSE_H Horizontal Positional Accuracy Class. The tested horizontal "
            "positional accuracy was found to be RMSE_H = 3.1 (cm).");
  const std::string few = AsprsStatement({29, 0.05, 0.0314, 0.054});
  EXPECT_TRUE(Has(few, "using ONLY 29 checkpoints. This data set was produced to meet a 5.0 (cm)")) << few;
  EXPECT_TRUE(Has(few, "RMSE_H = 3.1 (cm) using the reduced number of checkpoints."));
  EXPECT_TRUE(Has(AsprsStatement({1, 0.05, 0.03, 0.05}), "using ONLY 1 checkpoint."));
  const std::string none = AsprsStatement({0, 0.05, std::nullopt, std::nullopt});
  EXPECT_TRUE(Has(none, "was produced to meet"));
  EXPECT_FALSE(Has(none, "tested"));
}

TEST(StatementTest, NeverClaimsAClassThatWasNotMet) {
  for (const int n : {1, 10, 40}) {
    const std::string text = AsprsStatement({n, 0.05, 0.0801, 0.14});
    EXPECT_TRUE(Has(text, "RMSE_H = 8.0 (cm), which DOES NOT MEET a 5.0 (cm)")) << text;
    EXPECT_FALSE(Has(text, "to meet a") || Has(text, "tested to meet")) << text;
  }
}

TEST(StatementTest, MissingNumbersPrintAsBlanks) {
  EXPECT_TRUE(Has(AsprsStatement({40, std::nullopt, 0.03, 0.05}), "for a ___ (cm) RMSE_H"));
  EXPECT_TRUE(Has(NssdaStatement({0, std::nullopt, std::nullopt, std::nullopt}), "___ meters"));
}

TEST(StatementTest, Nssda) {
  EXPECT_EQ(NssdaStatement({20, 0.05, 0.03, 0.0519}),
            "Tested 0.052 meters horizontal accuracy at 95% confidence level.");
  EXPECT_TRUE(Has(NssdaStatement({19, 0.05, 0.03, 0.0519}), "needs at least 20 check points, 19 were tested"));
  EXPECT_EQ(NssdaStatement({0, 0.05, std::nullopt, std::nullopt}),
            "Compiled to meet 0.087 meters horizontal accuracy at 95% confidence level.");
}

}  // namespace
}  // namespace survey
