// SPDX-License-Identifier: Apache-2.0
#include "survey/geometry/pose2.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

TEST(Pose2, CompositionActsOnPointsAsOneAfterTheOther) {
  const Pose2 c_from_b{1.0, -2.0, 0.7};
  const Pose2 b_from_a{-0.3, 4.0, -2.9};
  const Eigen::Vector2d p_in_a(0.6, 1.1);
  EXPECT_LT((((c_from_b * b_from_a) * p_in_a) - (c_from_b * (b_from_a * p_in_a))).norm(), 1e-14);
}

TEST(Pose2, InverseAndBetweenUndo) {
  const Pose2 a{3.0, 1.0, 3.0};
  const Pose2 b{-5.0, 0.5, -2.0};
  const Pose2 back = a * Between(a, b);
  EXPECT_NEAR(back.x, b.x, 1e-13);
  EXPECT_NEAR(back.y, b.y, 1e-13);
  EXPECT_NEAR(NormalizeAngle(back.theta - b.theta), 0.0, 1e-14);
}

TEST(Pose2, AnglesWrapToTheShorterWay) {
  EXPECT_DOUBLE_EQ(NormalizeAngle(3.0 * std::numbers::pi), std::numbers::pi);
  EXPECT_DOUBLE_EQ(NormalizeAngle(-std::numbers::pi), std::numbers::pi);
  const Pose2 half = Interpolate({0, 0, 3.0}, {2, 0, -3.0}, 0.5);
  EXPECT_NEAR(std::abs(half.theta), std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(half.x, 1.0);
}

}  // namespace
}  // namespace survey
