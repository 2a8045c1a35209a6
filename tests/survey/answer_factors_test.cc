// SPDX-License-Identifier: Apache-2.0
//
// Answers in the adjustment of a block whose track drifts in heading: once around a square of 20 m, a node every half
// metre. Truth is the square.
#include "survey/graph/answer_factors.h"

#include <gtest/gtest.h>

#include "survey/graph/block_adjustment.h"

namespace survey {
namespace {

constexpr int kNodesOfSide = 40;
constexpr int kNodes = 4 * kNodesOfSide;
constexpr double kDrift_rad_per_node = 0.0015;

Pose2 Truth(int node) {
  const int side = node / kNodesOfSide;
  const double along = 0.5 * (node % kNodesOfSide);
  const Eigen::Vector2d corners[] = {{0, 0}, {20, 0}, {20, 20}, {0, 20}};
  const double heading = side * std::numbers::pi / 2.0;
  const Eigen::Vector2d p = corners[side] + along * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  return {500000.0 + p.x(), 5600000.0 + p.y(), NormalizeAngle(heading)};
}

void AddSubmap(int first, int end, Track* track) {
  const SubmapId id{static_cast<int>(track->submaps.size())};
  const auto pose = [&](int node) { return track->scans[static_cast<std::size_t>(node)].local_from_scan; };
  Submap submap{.id = id, .local_from_submap = pose(first)};
  for (int node = first; node < end; ++node) {
    submap.nodes.push_back({node});
    track->constraints.push_back(
        {id, {node}, Between(pose(first), pose(node)), Eigen::Vector3d(4e-4, 4e-4, 4e-5).asDiagonal()});
  }
  track->submaps.push_back(std::move(submap));
}

Track DriftedTrack() {
  Track track;
  Pose2 pose;
  for (int node = 0; node < kNodes; ++node) {
    if (node > 0) pose = pose * Between(Truth(node - 1), Truth(node)) * Pose2{0, 0, kDrift_rad_per_node};
    track.scans.push_back({.scan = {node},
                           .local_from_scan = pose,
                           .covariance = Eigen::Vector3d(4e-4, 4e-4, 4e-5).asDiagonal(),
                           .matched = true,
                           .is_node = true});
  }
  for (int first = 0; first + 10 < kNodes; first += 10) AddSubmap(first, std::min(first + 20, kNodes), &track);
  return track;
}

struct SquareWalk : public testing::Test {
  SquareWalk() {
    for (int node = 0; node < kNodes; ++node) stamps.push_back(1000000000L * node);
  }
  // Stood on control at nodes 2 and 38, on the first side.
  void Mark() {
    for (const int node : {2, 38}) {
      const std::string name = "P" + std::to_string(node);
      track.marks.push_back({.point = name,
                             .start_ns = 0,
                             .end_ns = 1,
                             .scan = {node},
                             .covariance = 1e-4 * Eigen::Matrix2d::Identity()});
      ControlPoint point{.name = name, .role = PointRole::kControl, .position_in_site = Truth(node).Translation()};
      point.covariance = 1e-6 * Eigen::Matrix2d::Identity();
      control.points.push_back(point);
    }
  }
  BlockAdjustment Adjust(const Answers& answers) const { return AdjustBlock(track, {}, control, stamps, {}, answers); }

  Track track = DriftedTrack();
  ControlNetwork control;
  std::vector<StampNs> stamps;
};

Answer InSite(int node, const Pose2& error = {}) {
  Answer answer{.name = "site.json", .scan = {node}, .decision = Decision::kCorrect, .sigma = {0.03, 0.03, 0.01}};
  const Pose2 truth = Truth(node);
  answer.site_from_scan = Pose2{truth.x + error.x, truth.y + error.y, truth.theta + error.theta};
  return answer;
}

double ErrorAt(const BlockAdjustment& adjustment, int node) {
  const Pose2& pose = adjustment.solution.scans[static_cast<std::size_t>(node)].site_from_scan;
  return (pose.Translation() - Truth(node).Translation()).norm();
}

TEST_F(SquareWalk, APoseInTheSiteHoldsWhatControlDoesNotReach) {
  Mark();
  const BlockAdjustment without = Adjust({});
  ASSERT_TRUE(without.usable) << without.message;
  EXPECT_GT(ErrorAt(without, 150), 0.5);
  const BlockAdjustment with = Adjust({InSite(150)});
  ASSERT_TRUE(with.usable) << with.message;
  EXPECT_LT(ErrorAt(with, 150), 0.05);
  ASSERT_EQ(with.answers.size(), 1U);
  EXPECT_EQ(with.answers[0].not_used, "");
  EXPECT_EQ(with.solution.statistics.degrees_of_freedom, without.solution.statistics.degrees_of_freedom + 3);
  EXPECT_LT(with.solution.covariances.back().scan.value, kNodes);
}

TEST_F(SquareWalk, ControlWinsAgainstAPoseThatContradictsIt) {
  Mark();
  const BlockAdjustment without = Adjust({});
  const BlockAdjustment with = Adjust({InSite(30, {0.9, 0.0, 0.0})});
  ASSERT_TRUE(with.usable) << with.message;
  EXPECT_EQ(with.answers[0].not_used, "it contradicts the control");
  EXPECT_EQ(with.solution.scans[30].site_from_scan.Vector(), without.solution.scans[30].site_from_scan.Vector());
  ASSERT_EQ(with.solution.findings.size(), without.solution.findings.size() + 1);
  EXPECT_EQ(with.solution.findings.back().rfind("answer site.json was not used: it contradicts the control", 0), 0U);
}

TEST_F(SquareWalk, WithoutControlThereIsNoSiteToBeIn) {
  const BlockAdjustment adjustment = Adjust({InSite(150)});
  ASSERT_TRUE(adjustment.usable);
  ASSERT_EQ(adjustment.solution.findings.size(), 1U);
  EXPECT_NE(adjustment.solution.findings[0].find("two control points do not tie the block"), std::string::npos);
}

TEST_F(SquareWalk, APoseFarFromTheWayIsRefused) {
  Mark();
  const BlockAdjustment adjustment = Adjust({InSite(150, {5000.0, 0.0, 0.0})});
  EXPECT_FALSE(adjustment.usable);
  EXPECT_EQ(adjustment.message,
            "answer site.json: pose: outside the map: farther than 100 m from the way of the block");
}

// One long wall 2 m to the south of the first side, seen from nodes 5 and 35; and the facade that the last side runs
// along, at right angles to it.
Answer Related(WallRelation relation, int node, double heading_in_site) {
  Answer answer{.name = "wall.json", .scan = {node}, .decision = Decision::kRelate, .reference = {5}};
  answer.wall_sigma = {0.02, 0.002};
  const auto wall_seen_from = [&](int from, double heading) {
    const Eigen::Vector2d middle(Truth(from).x, 5600000.0 - 2.0);
    const Eigen::Vector2d half = 1.5 * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    return Inverse(Truth(from)) * WallSegment{middle - half, middle + half};
  };
  answer.walls = WallPair{relation, wall_seen_from(5, 0.0), wall_seen_from(node, heading_in_site)};
  return answer;
}

double HeadingError(const BlockAdjustment& adjustment, int node) {
  const auto turn = [](const Pose2& a, const Pose2& b) { return Between(a, b).theta; };
  const std::vector<SolvedScan>& scans = adjustment.solution.scans;
  return std::abs(NormalizeAngle(turn(scans[5].site_from_scan, scans[static_cast<std::size_t>(node)].site_from_scan) -
                                 turn(Truth(5), Truth(node))));
}

TEST_F(SquareWalk, WallsThatAreOneLineTakeTheDriftOutOfHeadingAndOffset) {
  const BlockAdjustment without = Adjust({});
  const BlockAdjustment with = Adjust({Related(WallRelation::kCollinear, 35, 0.0)});
  ASSERT_TRUE(with.usable) << with.message;
  EXPECT_GT(HeadingError(without, 35), 0.04);
  EXPECT_LT(HeadingError(with, 35), 0.005);
  EXPECT_EQ(with.solution.statistics.degrees_of_freedom, without.solution.statistics.degrees_of_freedom + 2);
  EXPECT_FALSE(with.answers[0].in_conflict);
}

TEST_F(SquareWalk, PerpendicularWallsTakeTheDriftOutOfTheHeadingAlone) {
  const BlockAdjustment without = Adjust({});
  const BlockAdjustment with = Adjust({Related(WallRelation::kPerpendicular, 150, 0.5 * std::numbers::pi)});
  ASSERT_TRUE(with.usable) << with.message;
  EXPECT_LT(HeadingError(with, 150), 0.05 * HeadingError(without, 150));
  EXPECT_EQ(with.solution.statistics.degrees_of_freedom, without.solution.statistics.degrees_of_freedom + 1);
}

TEST_F(SquareWalk, AWrongAnswerIsNamedAndNotThoseThatItBends) {
  const auto at = [](int node) {
    Answer answer{.name = std::to_string(node), .scan = {node}, .decision = Decision::kCorrect, .reference = {90}};
    answer.reference_from_scan = Between(Truth(90), Truth(node));
    return answer;
  };
  Answers answers = {at(100), at(104), at(108), at(112)};
  answers[2].reference_from_scan.x += 2.0;
  const BlockAdjustment adjustment = AdjustBlock(track, {}, {}, stamps, {}, answers);
  ASSERT_EQ(adjustment.answers.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(adjustment.answers[i].in_conflict, i == 2) << i;
}

TEST_F(SquareWalk, ARelationThatTheWallsCannotHoldIsRefused) {
  const BlockAdjustment adjustment = Adjust({Related(WallRelation::kPerpendicular, 35, 0.0)});
  EXPECT_FALSE(adjustment.usable);
  EXPECT_NE(adjustment.message.find("answer wall.json: relation = perpendicular: the two walls are 87 degrees off"),
            std::string::npos)
      << adjustment.message;
}

// False loops, 2 m off but all of one opinion, from the end of the walk to its begin; answers that know better.
struct FalseLoops : public SquareWalk {
  FalseLoops() {
    for (int node = 140; node < kNodes; node += 2) {
      Loop loop{.constraint = {{0}, {node}, Between(Truth(0), Truth(node))}};
      loop.constraint.submap_from_scan.x += 2.0;
      loop.constraint.covariance = Eigen::Vector3d(4e-4, 4e-4, 1e-5).asDiagonal();
      loops.loops.push_back(loop);
    }
  }
  static Answer Correct(int node) {
    Answer answer{.name = std::to_string(node), .scan = {node}, .decision = Decision::kCorrect, .reference = {2}};
    answer.reference_from_scan = Between(Truth(2), Truth(node));
    return answer;
  }
  BlockAdjustment AdjustWithLoops(const Answers& answers) const {
    return AdjustBlock(track, loops, {}, stamps, {}, answers);
  }
  Loops loops;
};

TEST_F(FalseLoops, TwoAnswersFreeTheSolutionOneIsNamed) {
  const BlockAdjustment one = AdjustWithLoops({Correct(150)});
  EXPECT_TRUE(one.answers.at(0).in_conflict);
  const BlockAdjustment two = AdjustWithLoops({Correct(145), Correct(155)});
  ASSERT_EQ(two.answers.size(), 2U);
  EXPECT_FALSE(two.answers[0].in_conflict || two.answers[1].in_conflict);
  const Pose2 motion = Between(two.solution.scans[2].site_from_scan, two.solution.scans[150].site_from_scan);
  EXPECT_LT((motion.Translation() - Between(Truth(2), Truth(150)).Translation()).norm(), 0.2);
  EXPECT_EQ(two.solution.statistics.num_loops, 0);
  EXPECT_EQ(two.solution.findings.size(), 1U);  // which says so
}

TEST_F(FalseLoops, AnswersOfDifferentOpinionsDoNotFreeTheSolution) {
  Answer elsewhere = Correct(155);
  elsewhere.reference_from_scan.y += 2.0;
  const BlockAdjustment adjustment = AdjustWithLoops({Correct(145), elsewhere});
  EXPECT_TRUE(adjustment.answers.at(0).in_conflict && adjustment.answers.at(1).in_conflict);
  EXPECT_EQ(static_cast<std::size_t>(adjustment.solution.statistics.num_loops), loops.loops.size());
}

// Straight on for 30 m; between nodes 25 and 33 nothing was matched, and the odometry missed a turn.
TEST(BlindStretch, TakesTheErrorThatAnAnswerShowsAndTheRestStaysRigid) {
  Track track;
  std::vector<StampNs> stamps;
  const auto truth = [](int node) {
    const Pose2 pose{0.5 * node, 0.0, 0.0};
    const Pose2 fault{12.5, 0.25, 0.06};  // twice its sigmas
    return node < 33 ? pose : fault * Pose2{pose.x - 12.5, 0.0, 0.0};
  };
  for (int node = 0; node < 60; ++node) {
    const bool blind = node >= 25 && node < 33;
    const Eigen::Vector3d variances = blind ? Eigen::Vector3d(1.8e-3, 1.8e-3, 2e-4) : Eigen::Vector3d(1e-4, 1e-4, 1e-5);
    track.scans.push_back({.scan = {node},
                           .local_from_scan = {0.5 * node, 0.0, 0.0},
                           .covariance = variances.asDiagonal(),
                           .prediction = Prediction::kOdometry,
                           .matched = !blind,
                           .is_node = true});
    stamps.push_back(1000000000L * node);
  }
  for (int first = 0; first < 60; first += 20) AddSubmap(first, std::min(first + 40, 60), &track);
  Answer answer{.name = "a.json", .scan = {55}, .decision = Decision::kCorrect, .reference = {5}};
  answer.reference_from_scan = Between(truth(5), truth(55));
  answer.sigma = {0.02, 0.02, 0.005};
  const BlockAdjustment adjustment = AdjustBlock(track, {}, {}, stamps, {}, {answer});
  ASSERT_TRUE(adjustment.usable) << adjustment.message;
  const auto error = [&](int node) {
    const Pose2 moved = Between(adjustment.solution.scans[5].site_from_scan,
                                adjustment.solution.scans[static_cast<std::size_t>(node)].site_from_scan);
    return (moved.Translation() - Between(truth(5), truth(node)).Translation()).norm();
  };
  EXPECT_LT(error(20), 0.05);
  EXPECT_LT(error(40), 0.1);  // 0.7 m without the answer
  EXPECT_LT(error(55), 0.1);
  EXPECT_FALSE(adjustment.answers[0].in_conflict);
}

TEST(WallRelation, DerivativesAgreeWithDifferences) {
  const Eigen::Vector3d base(1.0, -2.0, 0.7);
  const Eigen::Vector3d target(3.0, 0.5, 0.9);
  const WallPair walls{WallRelation::kCollinear, {{1.0, 2.0}, {4.0, 2.5}}, {{-1.0, 1.0}, {2.0, 1.3}}};
  const auto error = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return EvaluateWalls(walls, Pose2::FromVector(a), Pose2::FromVector(b)).error;
  };
  const WallResidual r = EvaluateWalls(walls, Pose2::FromVector(base), Pose2::FromVector(target));
  const double h = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
    EXPECT_LT((r.d_base.col(k) - (error(base + step, target) - error(base - step, target)) / (2 * h)).norm(), 1e-8);
    EXPECT_LT((r.d_target.col(k) - (error(base, target + step) - error(base, target - step)) / (2 * h)).norm(), 1e-8);
  }
}

TEST(WallRelation, HandComputedDistanceAndAngleWhateverTheDirectionsOfTheWalls) {
  const WallPair walls{WallRelation::kCollinear, {{0.0, 1.0}, {4.0, 1.0}}, {{3.0, 0.5}, {1.0, 0.5}}};
  const WallResidual r = EvaluateWalls(walls, {0, 0, 0}, {10.0, 0.2, 0.0});
  EXPECT_NEAR(r.error.x(), 0.2 + 0.5 - 1.0, 1e-12);
  EXPECT_NEAR(r.error.y(), 0.0, 1e-12);
  const WallPair corner{WallRelation::kPerpendicular, walls.in_base, {{0.0, 0.0}, {0.1, -2.0}}};
  EXPECT_NEAR(EvaluateWalls(corner, {}, {}).error.y(), std::atan(0.05), 1e-12);
  EXPECT_EQ(EvaluateWalls(corner, {}, {}).error.x(), 0.0);
}

}  // namespace
}  // namespace survey
