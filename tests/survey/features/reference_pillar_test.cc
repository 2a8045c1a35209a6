// SPDX-License-Identifier: Apache-2.0
#include "survey/features/reference_pillar.h"

#include <gtest/gtest.h>

#include <vector>

namespace {

using Eigen::Vector2d;

void AddFace(const Vector2d& from, const Vector2d& to, std::vector<Vector2d>* points) {
  constexpr int kPoints = 60;
  for (int i = 0; i <= kPoints; ++i) points->push_back(from + (to - from) * i / kPoints);
}

// A pillar of 0.6 m about the origin whose southern face a car hides, 0.29 m away: its side is no face of the pillar.
TEST(ReferencePillarTest, ACarBesideIsNoFace) {
  std::vector<Vector2d> points;
  AddFace({-0.3, -0.3}, {-0.3, 0.3}, &points);
  AddFace({0.3, -0.3}, {0.3, 0.3}, &points);
  AddFace({-0.3, 0.3}, {0.3, 0.3}, &points);
  AddFace({-0.3, -0.588}, {0.3, -0.588}, &points);
  const std::vector<survey::PointCrossing> pillars = survey::FindPillars(points, {});
  ASSERT_EQ(pillars.size(), 1U);
  EXPECT_LT(pillars[0].p.norm(), 0.005) << pillars[0].p.transpose();
}

}  // namespace
