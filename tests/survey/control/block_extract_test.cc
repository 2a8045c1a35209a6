// SPDX-License-Identifier: Apache-2.0
#include "survey/control/block_extract.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

ControlNetwork Network() {
  ControlNetwork network{.frame = {.crs = "EPSG:25832"}};
  for (const auto& [name, role] : {std::pair{"C1", PointRole::kControl},
                                   {"C12", PointRole::kControl},
                                   {"K1", PointRole::kCheck},
                                   {"T1", PointRole::kTie},
                                   {"X1", PointRole::kExcluded}}) {
    network.points.push_back({.name = name, .role = role});
  }
  return network;
}

TEST(BlockExtractTest, HoldsOnlyMarkedControlAndTies) {
  const ControlNetwork extract = ExtractOfBlock(Network(), {"X1", "T1", "K1", "C1", "C1", "nowhere"});
  ASSERT_EQ(extract.points.size(), 2U);
  EXPECT_EQ(extract.points[0].name, "C1");
  EXPECT_EQ(extract.points[1].name, "T1");
  EXPECT_EQ(extract.frame.crs, "EPSG:25832");
  EXPECT_TRUE(ExtractOfBlock(Network(), {"K1", "X1"}).points.empty());
}

TEST(BlockExtractTest, FindsChecksThatAreControlUnderAnotherName) {
  ControlNetwork network = Network();
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    network.points[i].position_in_site = {10.0 * static_cast<double>(i), 0};
  }
  EXPECT_TRUE(ChecksOnControl(network, 0.05).empty());
  network.points[2].position_in_site = {10.03, 0};  // K1 beside C12
  ASSERT_EQ(ChecksOnControl(network, 0.05).size(), 1U);
  EXPECT_EQ(ChecksOnControl(network, 0.05)[0], (std::pair<std::string, std::string>("K1", "C12")));
}

TEST(BlockExtractTest, NamesTheLikelyMeaning) {
  EXPECT_EQ(SimilarNames(Network(), "c1", 1), std::vector<std::string>{"C1"});
  EXPECT_EQ(SimilarNames(Network(), "C13", 2), (std::vector<std::string>{"C1", "C12"}));
  EXPECT_TRUE(SimilarNames(Network(), "pillar", 3).empty());
}

}  // namespace
}  // namespace survey
