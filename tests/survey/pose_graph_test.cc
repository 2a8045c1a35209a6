// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/pose_graph.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "survey/graph/chordal_start.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/graph_residuals.h"
#include "survey/graph/variance_components.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

TEST(GraphResiduals, DerivativesAgreeWithDifferences) {
  const Eigen::Vector3d base(1.0, -2.0, 0.7);
  const Eigen::Vector3d target(3.0, 0.5, -1.1);
  const Pose2 measured{2.0, 0.3, -1.9};
  const Eigen::Vector2d point(2.0, 4.0);
  const Eigen::Vector2d in_pose(0.3, 0.9);
  const double h = 1e-6;
  const auto relative = EvaluateRelativePose(Pose2::FromVector(base), Pose2::FromVector(target), measured);
  const auto mark = EvaluateMark(Pose2::FromVector(base), point, in_pose);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
    const Eigen::Vector3d d_base =
        (EvaluateRelativePose(Pose2::FromVector(base + step), Pose2::FromVector(target), measured).error -
         EvaluateRelativePose(Pose2::FromVector(base - step), Pose2::FromVector(target), measured).error) /
        (2 * h);
    const Eigen::Vector3d d_target =
        (EvaluateRelativePose(Pose2::FromVector(base), Pose2::FromVector(target + step), measured).error -
         EvaluateRelativePose(Pose2::FromVector(base), Pose2::FromVector(target - step), measured).error) /
        (2 * h);
    const Eigen::Vector2d d_pose = (EvaluateMark(Pose2::FromVector(base + step), point, in_pose).error -
                                    EvaluateMark(Pose2::FromVector(base - step), point, in_pose).error) /
                                   (2 * h);
    EXPECT_LT((relative.d_base.col(k) - d_base).norm(), 1e-8);
    EXPECT_LT((relative.d_target.col(k) - d_target).norm(), 1e-8);
    EXPECT_LT((mark.d_pose.col(k) - d_pose).norm(), 1e-8);
  }
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(k);
    const Eigen::Vector2d d_point = (EvaluateMark(Pose2::FromVector(base), point + step, in_pose).error -
                                     EvaluateMark(Pose2::FromVector(base), point - step, in_pose).error) /
                                    (2 * h);
    EXPECT_LT((mark.d_point.col(k) - d_point).norm(), 1e-8);
  }
}

// A square walk of 40 poses with noisy motions.
PoseGraph NoisyWalk(std::uint32_t seed, double sigma_m, double sigma_rad) {
  const RandomStream noise(1, 1, seed);
  PoseGraph graph;
  graph.poses.push_back({});
  for (int i = 1; i < 40; ++i) {
    const auto [nx, ny] = noise.Normals(2 * static_cast<std::uint64_t>(i));
    const double nt = noise.Normal(2 * static_cast<std::uint64_t>(i) + 1);
    const Pose2 motion{1.0 + sigma_m * nx, sigma_m * ny, (i % 10 == 0 ? 1.5707963267948966 : 0.0) + sigma_rad * nt};
    graph.edges.push_back({i - 1, i, motion,
                           Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal(),
                           false});
    graph.poses.push_back(graph.poses.back() * motion);
  }
  graph.fixed_pose = 0;
  return graph;
}

TEST(PoseGraph, ALoopRemovesTheDriftAndChiSquareIsHonest) {
  double sum = 0.0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    PoseGraph graph = NoisyWalk(seed, 0.02, 0.005);
    // True end: (0, 1) looking along -y, one metre before the start.
    graph.edges.push_back({0, 39, {0, 1, -1.5707963267948966}, Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal(), false});
    const PoseGraphSummary summary = Solve(&graph, {});
    ASSERT_TRUE(summary.usable);
    EXPECT_LT((graph.poses.back().Translation() - Eigen::Vector2d(0, 1)).norm(), 0.01);
    sum += 2.0 * summary.final_cost;
  }
  EXPECT_NEAR(sum / 60, 3.0, 1.0);  // one loop: three degrees of freedom
}

TEST(PoseGraph, ARobustLoopThatIsWrongMovesLittle) {
  PoseGraph graph = NoisyWalk(3, 0.02, 0.005);
  const PoseGraph before = graph;
  graph.edges.push_back({5, 25, {0, 0, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal(), true});
  Solve(&graph, {});
  EXPECT_LT((graph.poses.back().Translation() - before.poses.back().Translation()).norm(), 0.05);
}

TEST(PoseGraph, CovariancesEqualTheDenseInverse) {
  PoseGraph graph;
  graph.poses = {{0, 0, 0}, {1, 0, 0.3}, {2, 0.4, 0.6}};
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.02, 0.001).asDiagonal();
  graph.edges = {{0, 1, Between(graph.poses[0], graph.poses[1]), covariance, false},
                 {1, 2, Between(graph.poses[1], graph.poses[2]), covariance, false}};
  graph.points = {{0.5, 0.5}, {3, 0}};
  Eigen::Matrix4d of_given = Eigen::Vector4d(1e-4, 1e-4, 4e-4, 4e-4).asDiagonal();
  of_given(0, 2) = of_given(2, 0) = 1e-4;
  of_given(1, 3) = of_given(3, 1) = -5e-5;
  graph.given = {{{0, 1}, Eigen::Vector4d(0.5, 0.5, 3, 0), of_given}};
  const Eigen::Matrix2d mark_covariance = 1e-4 * Eigen::Matrix2d::Identity();
  graph.marks = {{0, 0, Inverse(graph.poses[0]) * graph.points[0], mark_covariance},
                 {2, 1, Inverse(graph.poses[2]) * graph.points[1], mark_covariance}};

  // Unknowns: three poses, two points, in this order.
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(13, 13);
  for (const PoseEdge& edge : graph.edges) {
    const auto r = EvaluateRelativePose(graph.poses[static_cast<std::size_t>(edge.base)],
                                        graph.poses[static_cast<std::size_t>(edge.target)], edge.base_from_target);
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, 13);
    row.block<3, 3>(0, 3 * edge.base) = r.d_base;
    row.block<3, 3>(0, 3 * edge.target) = r.d_target;
    normal += row.transpose() * edge.covariance.inverse() * row;
  }
  for (const MarkEdge& mark : graph.marks) {
    const auto r = EvaluateMark(graph.poses[static_cast<std::size_t>(mark.pose)],
                                graph.points[static_cast<std::size_t>(mark.point)], mark.p_in_pose);
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, 13);
    row.block<2, 3>(0, 3 * mark.pose) = r.d_pose;
    row.block<2, 2>(0, 9 + 2 * mark.point) = r.d_point;
    normal += row.transpose() * mark.covariance.inverse() * row;
  }
  normal.block<4, 4>(9, 9) += of_given.inverse();
  const Eigen::MatrixXd inverse = normal.inverse();
  const std::optional<GraphCovariance> computed = GraphCovariance::Of(graph);
  ASSERT_TRUE(computed);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT((computed->OfPose(i) - inverse.block<3, 3>(3 * i, 3 * i)).norm(), 1e-9 * inverse.norm());
}

// Redundancy numbers of all observations sum to the degrees of freedom.
TEST(GraphCovariance, RedundanciesSumToTheDegreesOfFreedom) {
  PoseGraph graph = NoisyWalk(7, 0.02, 0.005);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-4, 4e-4, 1e-4).asDiagonal();
  for (const auto& [base, target] : {std::pair{0, 39}, {3, 22}, {30, 8}}) {
    graph.edges.push_back(
        {base, target,
         Between(graph.poses[static_cast<std::size_t>(base)], graph.poses[static_cast<std::size_t>(target)]),
         covariance, false});
  }
  const auto computed = GraphCovariance::Of(graph);
  ASSERT_TRUE(computed);
  double sum = 0.0;
  for (const PoseEdge& edge : graph.edges) {
    const double redundancy = computed->RedundancyOf(edge);
    EXPECT_GE(redundancy, -1e-9);
    EXPECT_LE(redundancy, 3.0);
    sum += redundancy;
  }
  EXPECT_NEAR(sum, 9.0, 1e-6);
  EXPECT_EQ(computed->OfPose(0), Eigen::Matrix3d::Zero());
}

// Two walks of 40 steps with loops across, by covariances that are wrong by two different factors.
TEST(VarianceComponents, TellHowFarOffTheCovariancesWere) {
  constexpr double kTrackFactor = 9.0;
  constexpr double kLoopFactor = 4.5;
  double of_track = 0.0;
  double of_loops = 0.0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    PoseGraph graph = NoisyWalk(seed, 0.02, 0.005);
    std::vector<Pose2> truth = {{}};
    for (int i = 1; i < 40; ++i)
      truth.push_back(truth.back() * Pose2{1.0, 0.0, i % 10 == 0 ? 1.5707963267948966 : 0.0});
    const RandomStream noise(3, 1, seed);
    for (int i = 0; i < 18; ++i) {
      const auto [nx, ny] = noise.Normals(2 * static_cast<std::uint64_t>(i));
      const double nt = noise.Normal(2 * static_cast<std::uint64_t>(i) + 1);
      const Pose2 error{0.02 * nx, 0.02 * ny, 0.005 * nt};
      graph.edges.push_back(
          {i, 39 - i, Between(truth[static_cast<std::size_t>(i)], truth[static_cast<std::size_t>(39 - i)]) * error,
           kLoopFactor * Eigen::Matrix3d(Eigen::Vector3d(4e-4, 4e-4, 2.5e-5).asDiagonal()), true, EdgeKind::kLoop});
    }
    for (PoseEdge& edge : graph.edges) {
      if (edge.kind != EdgeKind::kLoop) edge.covariance *= kTrackFactor;
    }
    const FreeSolution free = SolveFree({}, &graph);
    ASSERT_TRUE(free.summary.usable && free.factors.told);
    of_track += std::log(free.factors.track) / 20;
    of_loops += std::log(free.factors.loops) / 20;
  }
  EXPECT_NEAR(of_track, -std::log(kTrackFactor), 0.25);
  EXPECT_NEAR(of_loops, -std::log(kLoopFactor), 0.25);
}

// A second copy of the track fits the first whatever the errors of both: it must not make them look better.
TEST(VarianceComponents, CopiesOfTheTrackTellNothing) {
  PoseGraph graph = NoisyWalk(4, 0.02, 0.005);
  const std::size_t num_motions = graph.edges.size();
  for (std::size_t i = 0; i < num_motions; ++i) graph.edges.push_back(graph.edges[i]);
  const KindEvidence alone = TrackAlone(graph).value();
  EXPECT_NEAR(alone.redundancy, 3.0 * static_cast<double>(num_motions), 1e-6);
  EXPECT_NEAR(alone.squares, 0.0, 1e-9);
  for (const auto& [base, target] : {std::pair{0, 39}, {3, 30}}) {
    graph.edges.push_back(
        {base, target,
         Between(graph.poses[static_cast<std::size_t>(base)], graph.poses[static_cast<std::size_t>(target)]),
         graph.edges.front().covariance, true, EdgeKind::kLoop});
  }
  const auto covariance = GraphCovariance::Of(graph);
  ASSERT_TRUE(covariance);
  const KindEvidence track = Beyond(EvidenceOf(graph, *covariance, {EdgeKind::kMotion, EdgeKind::kScanMatch}), alone);
  EXPECT_NEAR(track.redundancy + EvidenceOf(graph, *covariance, {EdgeKind::kLoop}).redundancy, 6.0, 1e-6);
}

TEST(VarianceComponents, StayNearToWhatIsUsualWhereFewLoopsTell) {
  PoseGraph graph = NoisyWalk(2, 0.02, 0.005);
  graph.edges.push_back(
      {5, 25, Between(graph.poses[5], graph.poses[25]), graph.edges.front().covariance, true, EdgeKind::kLoop});
  const FreeSolution free = SolveFree({}, &graph);
  EXPECT_FALSE(free.factors.told);
  EXPECT_GT(free.factors.track, 0.01);
}

TEST(SelectedInverse, EqualsTheDenseInverseWhereTheMatrixIsNotZero) {
  constexpr int kSize = 60;
  const RandomStream noise(2, 1, 5);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    dense(i, i) = 8.0;
    for (const int gap : {1, 7, 31}) {
      if (i >= gap) dense(i, i - gap) = dense(i - gap, i) = noise.Normal(static_cast<std::uint64_t>(100 * i + gap));
    }
  }
  const Eigen::MatrixXd inverse = dense.inverse();
  const Eigen::SparseMatrix<double> lower = Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
  const auto selected = SelectedInverse::Of(lower);
  ASSERT_TRUE(selected);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      if (dense(i, j) == 0.0) continue;
      EXPECT_NEAR((*selected)(i, j), inverse(i, j), 1e-12);
    }
  }
  EXPECT_FALSE(SelectedInverse::Of(-lower));
}

TEST(ChordalStart, IsExactWithoutNoiseHoweverFarOffThePosesAre) {
  PoseGraph graph = NoisyWalk(1, 0.1, 0.1);
  const std::vector<Pose2> truth = graph.poses;
  graph.edges.push_back({31, 4, Between(truth[31], truth[4]), Eigen::Matrix3d(0.01 * Eigen::Matrix3d::Identity())});
  graph.fixed_pose = 12;
  graph.points.resize(1);
  graph.marks.push_back({20, 0, {1.0, 2.0}});
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i != 12) graph.poses[i] = {100.0, -50.0, 3.0};
  }
  const auto start = ChordalStart(graph);
  ASSERT_TRUE(start);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((start->poses[i].Translation() - truth[i].Translation()).norm(), 1e-8);
    EXPECT_LT(std::abs(NormalizeAngle(start->poses[i].theta - truth[i].theta)), 1e-9);
  }
  EXPECT_LT((start->points[0] - truth[20] * Eigen::Vector2d(1.0, 2.0)).norm(), 1e-8);
  graph.edges.erase(graph.edges.begin() + 34);  // the end hangs in the air
  EXPECT_FALSE(ChordalStart(graph));
}

TEST(PoseGraph, WithoutDatumThereAreNoCovariances) {
  PoseGraph graph = NoisyWalk(1, 0.02, 0.005);
  graph.fixed_pose.reset();
  EXPECT_FALSE(GraphCovariance::Of(graph));
}

}  // namespace
}  // namespace survey
