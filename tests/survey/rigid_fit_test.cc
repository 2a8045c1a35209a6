// SPDX-License-Identifier: Apache-2.0
#include "survey/geometry/rigid_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "survey/geometry/principal_axes.h"

namespace survey {
namespace {

TEST(FitRigid, RecoversTheMotionAndTheScaleThatSeparatesTheSets) {
  const Pose2 truth{500000.0, 5600000.0, -2.4};
  const std::vector<Eigen::Vector2d> source = {{0, 0}, {10, 1}, {3, -7}, {-4, 5}};
  std::vector<Eigen::Vector2d> target;
  for (const auto& p : source) target.push_back(truth * Eigen::Vector2d(1.0002 * p));
  const auto fit = FitRigid(source, target);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->target_from_source.theta, truth.theta, 1e-9);
  EXPECT_NEAR(fit->similarity_scale, 1.0002, 1e-9);
}

TEST(PrincipalAxes, RebuildTheMatrix) {
  for (const double degrees : {-80.0, 0.0, 17.0, 45.0, 90.0}) {
    const double angle = degrees * M_PI / 180.0;
    const Eigen::Vector2d major(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d minor(-major.y(), major.x());
    const Eigen::Matrix2d matrix = 9.0 * major * major.transpose() - 2.0 * minor * minor.transpose();
    const PrincipalAxes principal = PrincipalAxesOf(matrix);
    EXPECT_NEAR(principal.values[0], -2.0, 1e-12);
    EXPECT_NEAR(principal.values[1], 9.0, 1e-12);
    EXPECT_NEAR(std::abs(principal.axes.col(1).dot(major)), 1.0, 1e-12);
    EXPECT_NEAR((principal.axes.transpose() * principal.axes - Eigen::Matrix2d::Identity()).norm(), 0.0, 1e-12);
  }
}

TEST(FitRigid, IsStationaryUnderSmallMotions) {
  const std::vector<Eigen::Vector2d> source = {{0, 0}, {10, 1}, {3, -7}};
  const std::vector<Eigen::Vector2d> target = {{1, 0.2}, {10.9, 1.3}, {4.05, -6.9}};
  const std::vector<double> weights = {1.0, 2.0, 0.5};
  const auto fit = FitRigid(source, target, weights);
  ASSERT_TRUE(fit);
  const auto cost = [&](const Pose2& pose) {
    double sum = 0;
    for (std::size_t i = 0; i < source.size(); ++i) sum += weights[i] * (target[i] - pose * source[i]).squaredNorm();
    return sum;
  };
  const Pose2 best = fit->target_from_source;
  for (const Pose2& d : {Pose2{1e-4, 0, 0}, Pose2{0, 1e-4, 0}, Pose2{0, 0, 1e-4}}) {
    EXPECT_GT(cost({best.x + d.x, best.y + d.y, best.theta + d.theta}), cost(best));
    EXPECT_GT(cost({best.x - d.x, best.y - d.y, best.theta - d.theta}), cost(best));
  }
}

TEST(FitRigid, RefusesWhatDoesNotFixTheRotation) {
  const std::vector<Eigen::Vector2d> one = {{1, 1}};
  const std::vector<Eigen::Vector2d> same = {{1, 1}, {1, 1}};
  EXPECT_FALSE(FitRigid(one, one));
  EXPECT_FALSE(FitRigid(same, same));
}

TEST(FitRigid, AMirrorImageIsTold) {
  const std::vector<Eigen::Vector2d> source = {{0, 0}, {10, 1}, {3, -7}};
  std::vector<Eigen::Vector2d> target;
  for (const Eigen::Vector2d& p : source) target.push_back(Pose2{500.0, 600.0, 0.7} * p);
  EXPECT_FALSE(FitsOnlyMirrored(source, target));
  target[1].x() += 6.0;  // a blunder is no mirror
  EXPECT_FALSE(FitsOnlyMirrored(source, target));
  target.clear();
  for (const Eigen::Vector2d& p : source) target.push_back(Pose2{500.0, 600.0, 0.7} * Eigen::Vector2d(-p.x(), p.y()));
  EXPECT_TRUE(FitsOnlyMirrored(source, target));
  EXPECT_FALSE(FitsOnlyMirrored(std::span(source).first(2), std::span(target).first(2)));
}

TEST(FitRigid, TheRobustFitIgnoresAlmostHalfOfThePairs) {
  const Pose2 truth{500123.0, 5600456.0, 2.1};
  std::vector<Eigen::Vector2d> source, target;
  for (int i = 0; i < 9; ++i) {
    source.push_back({10.0 * (i % 3), 7.0 * i});
    target.push_back(truth * source.back() + Eigen::Vector2d(0.001 * (i % 2), -0.002 * (i % 3)));
  }
  const RigidFit clean = *FitRigid(source, target);
  const RigidFit same = *FitRigidRobust(source, target);
  EXPECT_LT((same.target_from_source.Vector() - clean.target_from_source.Vector()).norm(), 0.003);
  target[1].x() += 1000.0;  // a digit
  std::swap(target[4], target[7]);
  const RigidFit robust = *FitRigidRobust(source, target);
  EXPECT_LT((robust.target_from_source * source[8] - truth * source[8]).norm(), 0.006);
  EXPECT_GT((FitRigid(source, target)->target_from_source * source[8] - truth * source[8]).norm(), 1.0);
}

}  // namespace
}  // namespace survey
