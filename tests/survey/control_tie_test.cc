// SPDX-License-Identifier: Apache-2.0
//
// Tests of control in a block's adjustment: closed forms against solving again, planted errors, Monte Carlo.
#include "survey/graph/control_tie.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "survey/graph/blunder_causes.h"
#include "survey/graph/control_misfit.h"
#include "survey/graph/control_tests.h"
#include "survey/graph/given_control.h"
#include "survey/graph/graph_covariance.h"
#include "tests/support/garage_block.h"

namespace survey {
namespace {

using test_support::AdjustGarageBlock;
using test_support::GarageBlock;
using test_support::SimulateGarageBlock;
using test_support::SolveGarageBlockFree;
using test_support::TieGarageBlock;

TEST(GiveControl, PutsCorrelatedPointsIntoOneGroup) {
  ControlNetwork network;
  for (const char* name : {"A", "B", "C", "D"}) {
    ControlPoint point{.name = name};
    point.position_in_site = {100.0 + static_cast<double>(network.points.size()), 200.0};
    point.covariance = 9e-6 * Eigen::Matrix2d::Identity();
    network.points.push_back(point);
  }
  Eigen::Matrix2d between;
  between << 4e-6, 1e-6, 0.0, 4e-6;
  network.correlations = {{0, 2, between}, {1, 3, between}};
  const GivenControl given = GiveControl(network, {"A", "C", "D"}, {}, {100.0, 200.0});
  ASSERT_EQ(given.given.size(), 2U);  // A with C; D alone, for B is not marked
  EXPECT_EQ(given.given[0].points, (std::vector<int>{0, 1}));
  EXPECT_EQ(given.given[0].coordinates, Eigen::Vector4d(0, 0, 2, 0));
  EXPECT_EQ((given.given[0].covariance.block<2, 2>(2, 0)), between.transpose());
  EXPECT_TRUE(given.problem.empty());

  network.correlations.front().covariance = 1e-5 * Eigen::Matrix2d::Identity();  // more than either has by itself
  EXPECT_NE(GiveControl(network, {"A", "C"}, {}, {0.0, 0.0}).problem.find("around A"), std::string::npos);
}

TEST(ControlTie, LeavingOutInClosedFormEqualsSolvingAgain) {
  GarageBlock clean = SimulateGarageBlock(4);
  SolveGarageBlockFree(&clean);
  GarageBlock all = clean;
  const ControlTie tie = TieGarageBlock(&all);
  ASSERT_TRUE(tie.usable) << tie.message;
  for (std::size_t mark = 0; mark < clean.num_marks(); mark += 3) {
    GarageBlock without = clean;
    without.PointOfMark(mark).role = PointRole::kTie;
    const ControlTie solved = TieGarageBlock(&without);
    ASSERT_FALSE(solved.marks[mark].on_control);
    const MarkEdge& edge = without.block.graph.marks[mark];
    const Eigen::Vector2d place =
        without.block.graph.poses[static_cast<std::size_t>(edge.pose)] * edge.p_in_pose + solved.offset;
    const MarkTest& test = *tie.marks[mark].test;
    const double sigma = std::sqrt(test.left_out_covariance.trace());
    EXPECT_LT((place - tie.marks[mark].given - test.left_out).norm(), 0.03 * sigma) << mark;  // turns are not linear
    // Sigma: that of the place without the mark, and of the mark and the point themselves.
    const auto covariance = GraphCovariance::Of(without.block.graph);
    const double of_pose = covariance->OfPose(edge.pose).topLeftCorner<2, 2>().trace();
    const double own = edge.covariance.trace() + without.PointOfMark(mark).covariance.trace();
    // Control points share 2 mm: place and point move together.
    EXPECT_NEAR(test.left_out_covariance.trace(), of_pose + own - 2.0 * 2.0 * 4e-6, 0.02 * (of_pose + own)) << mark;
  }
}

TEST(ControlTie, RedundanciesSumToTheDegreesOfFreedom) {
  GarageBlock garage = SimulateGarageBlock(9);
  const ControlTie tie = AdjustGarageBlock(&garage);
  const PoseGraph& graph = garage.block.graph;
  const auto covariance = GraphCovariance::Of(graph);
  double sum = tie.of_control.redundancy;
  for (const PoseEdge& edge : graph.edges) sum += covariance->RedundancyOf(edge);
  const auto rows = static_cast<double>(3 * graph.edges.size() + 2 * graph.marks.size());
  EXPECT_NEAR(sum, rows - 3.0 * static_cast<double>(graph.poses.size()), 1e-4);
  for (const TiedMark& mark : tie.marks) {
    EXPECT_GT(mark.test->redundancy, 0.0);
    EXPECT_LT(mark.test->redundancy, 1.0);
  }
}

// An error of MDB size, not left out, moves no pose further than the external reliability says, and some pose so far.
TEST(ControlTie, ExternalReliabilityIsTheLargestShiftOfAPose) {
  GarageBlock clean = SimulateGarageBlock(5);
  SolveGarageBlockFree(&clean);
  constexpr std::size_t kMark = 4;
  const double size = 0.02;
  GarageBlock still = clean;
  const ControlTie b = TieGarageBlock(&still);
  double largest = 0.0;
  for (int k = 0; k < 16; ++k) {
    const double direction = k * 0.39269908;
    GarageBlock moved = clean;
    moved.PointOfMark(kMark).position_in_site += size * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    const ControlTie a = TieGarageBlock(&moved);
    ASSERT_TRUE(a.marks[kMark].used);
    for (std::size_t i = 0; i < moved.block.graph.poses.size(); ++i) {
      largest = std::max(largest, (moved.block.graph.poses[i].Translation() + a.offset -
                                   still.block.graph.poses[i].Translation() - b.offset)
                                      .norm());
    }
  }
  const MarkTest& test = *b.marks[kMark].test;
  EXPECT_NEAR(*test.largest_shift / *test.detectable, largest / size, 0.15 * largest / size);
}

// No loops, and sigmas that are ten times too small: good marks must not pay for it, a gross error must still be found.
TEST(ControlTie, ControlWidensAnOptimisticNetwork) {
  int spared = 0;
  int found = 0;
  for (std::uint32_t seed = 20; seed < 30; ++seed) {
    GarageBlock optimistic = SimulateGarageBlock(seed);
    std::erase_if(optimistic.block.graph.edges, [](const PoseEdge& edge) { return edge.kind == EdgeKind::kLoop; });
    for (PoseEdge& edge : optimistic.block.graph.edges) edge.covariance /= 100.0;
    SolveGarageBlockFree(&optimistic);
    GarageBlock good = optimistic;
    const ControlTie tie = TieGarageBlock(&good);
    spared += std::all_of(tie.marks.begin(), tie.marks.end(), [](const TiedMark& mark) { return mark.used; }) ? 1 : 0;
    optimistic.PointOfMark(5).position_in_site.x() += 10.0;
    const ControlTie with_error = TieGarageBlock(&optimistic);
    found += with_error.marks[5].used || !with_error.marks[4].used ? 0 : 1;
  }
  EXPECT_GE(spared, 9);
  EXPECT_GE(found, 9);
}

// Mark 5 of this block is one of those rare good ones that are left out by themselves: the exchange is named still.
TEST(ControlTie, AnExchangeIsNamedBesideAnErrorOfItsOwn) {
  GarageBlock garage = SimulateGarageBlock(75);
  std::swap(garage.PointOfMark(5).position_in_site, garage.PointOfMark(10).position_in_site);
  const ControlTie tie = AdjustGarageBlock(&garage);
  EXPECT_EQ(tie.marks[5].left_out.rfind("C105 and C110 look exchanged", 0), 0U) << tie.marks[5].left_out;
  EXPECT_EQ(tie.marks[10].left_out, tie.marks[5].left_out);
}

TEST(ControlTests, ControlAndNetworkShareTheConditions) {
  GarageBlock garage = SimulateGarageBlock(12);
  AdjustGarageBlock(&garage);
  PoseGraph& graph = garage.block.graph;
  const auto misfit = MisfitOfControl(graph, graph.given);
  ASSERT_TRUE(misfit);
  const ControlTests tests(*misfit, {0, 1, 2, 3, 5, 8, 9});
  const auto control = tests.ComponentOfControl();
  const auto network = tests.ComponentOfNetwork();
  EXPECT_NEAR(control.redundancy + network.redundancy, 11.0, 1e-6);
  EXPECT_NEAR(control.squares + network.squares, tests.chi_square(), 1e-6 * tests.chi_square());
}

// A point that was marked twice: wrong coordinates blame both marks, one wrong mark only itself.
TEST(ControlTie, TellsAWrongPointFromAWrongMark) {
  GarageBlock clean = SimulateGarageBlock(8);
  PoseGraph& graph = clean.block.graph;
  const std::size_t lap = graph.poses.size() / 2;
  MarkEdge again = graph.marks[5];
  again.pose += static_cast<int>(lap);
  graph.marks.push_back(again);

  GarageBlock wrong_point = clean;
  wrong_point.PointOfMark(5).position_in_site += Eigen::Vector2d(0.4, -0.3);
  const ControlTie point = AdjustGarageBlock(&wrong_point);
  EXPECT_FALSE(point.marks[5].used);
  EXPECT_FALSE(point.marks.back().used);
  // The point is not fixed any more but still ties its marks together.
  EXPECT_EQ(wrong_point.block.graph.marks[5].point, wrong_point.block.graph.marks.back().point);

  GarageBlock wrong_mark = clean;
  wrong_mark.block.graph.marks.back().p_in_pose += Eigen::Vector2d(0.4, -0.3);
  const ControlTie mark = AdjustGarageBlock(&wrong_mark);
  EXPECT_TRUE(mark.marks[5].used);
  EXPECT_FALSE(mark.marks.back().used);
}

TEST(ControlTie, ManyBlundersGiveAVerdictAndNothingIsLeftOut) {
  GarageBlock garage = SimulateGarageBlock(6);
  for (std::size_t mark = 0; mark < garage.num_marks(); ++mark)
    garage.PointOfMark(mark).position_in_site +=
        Eigen::Vector2d(std::cos(9.0 * static_cast<double>(mark)), 1.0 * static_cast<double>(mark % 4));
  const ControlTie tie = AdjustGarageBlock(&garage);
  ASSERT_TRUE(tie.usable) << tie.message;
  EXPECT_TRUE(tie.verdict.contradicted);
  for (const TiedMark& mark : tie.marks) EXPECT_TRUE(mark.used);
  ASSERT_FALSE(tie.findings.empty());
  EXPECT_NE(tie.findings.front().find("contradict"), std::string::npos);
}

// All points but these become ties: positions only.
void LeaveOnControl(std::initializer_list<std::size_t> marks, GarageBlock* garage) {
  for (std::size_t mark = 0; mark < garage->num_marks(); ++mark) {
    if (std::find(marks.begin(), marks.end(), mark) == marks.end()) garage->PointOfMark(mark).role = PointRole::kTie;
  }
}

// One condition, the distance: no mark can be tested, the map can.
TEST(ControlTie, TwoPointsAtAnotherDistanceAreAContradiction) {
  GarageBlock garage = SimulateGarageBlock(6);
  LeaveOnControl({1, 5}, &garage);
  EXPECT_FALSE(AdjustGarageBlock(&garage).verdict.contradicted);
  garage.PointOfMark(5).position_in_site += Eigen::Vector2d(3.0, 3.0);
  const ControlTie tie = AdjustGarageBlock(&garage);
  ASSERT_TRUE(tie.usable) << tie.message;
  EXPECT_TRUE(tie.verdict.contradicted);
  EXPECT_GT(tie.verdict.chi_square, 100.0);
}

// A lidar upside down: of three marks one would be left out, and the two others would fit.
TEST(ControlTie, AMirroredBlockIsRefused) {
  GarageBlock garage = SimulateGarageBlock(6);
  LeaveOnControl({0, 4, 8}, &garage);
  for (ControlPoint& point : garage.control.points) point.position_in_site.x() = 1e6 - point.position_in_site.x();
  const ControlTie tie = AdjustGarageBlock(&garage);
  EXPECT_FALSE(tie.usable);
  EXPECT_NE(tie.message.find("mirror image"), std::string::npos) << tie.message;
}

TEST(ControlTie, AScaleIsFoundAndNotApplied) {
  GarageBlock garage = SimulateGarageBlock(7);
  for (ControlPoint& point : garage.control.points)
    point.position_in_site =
        Eigen::Vector2d(500100, 5600200) + 1.003 * (point.position_in_site - Eigen::Vector2d(500100, 5600200));
  const ControlTie tie = AdjustGarageBlock(&garage);
  EXPECT_NEAR(tie.verdict.scale_deviation, 0.003, 4.0 * tie.verdict.scale_sigma);
  bool named = false;
  for (const std::string& finding : tie.findings) named = named || finding.find("scale") != std::string::npos;
  EXPECT_TRUE(named);
}

TEST(BlunderCauses, MistypedCoordinatesAreNamed) {
  PlaceByOthers point{.given = {500132.456, 5600123.4}, .error = {9.004, -0.002}};
  point.covariance = 1e-4 * Eigen::Matrix2d::Identity();
  const auto exchanged_digits = MistypedCoordinates(point);
  ASSERT_TRUE(exchanged_digits);
  EXPECT_NE(exchanged_digits->find("easting 500132.456 looks mistyped: 500123.456"), std::string::npos)
      << *exchanged_digits;

  point.given.y() = 5600523.4;
  point.error = {0.003, 400.001};
  const auto digit = MistypedCoordinates(point);
  ASSERT_TRUE(digit);
  EXPECT_NE(digit->find("5600123.400"), std::string::npos) << *digit;

  point.error = {0.25, 0.31};  // nothing to type wrong
  EXPECT_FALSE(MistypedCoordinates(point));
  point.given = {230.0, 410.0};
  point.error = {-180.002, 180.001};
  EXPECT_EQ(*MistypedCoordinates(point), "easting and northing look exchanged");
}

TEST(BlunderCauses, AMarkWithAnotherPointsLabelIsNamed) {
  SuspectMark suspect{"C1", {{10, 10}, {-5.8, 0.01}, 1e-4 * Eigen::Matrix2d::Identity()}, {}};
  const auto sentences = ExplainBlunders({suspect}, {}, {{"C1", {10, 10}}, {"C2", {15.81, 9.99}}, {"C3", {4, 4}}});
  EXPECT_NE(sentences.front().find("looks like a mark on C2"), std::string::npos) << sentences.front();
}

TEST(ControlTie, MonteCarlo) {
  const auto counts = test_support::CountReliability(1000, 50);
  const auto share = [&](int count) { return static_cast<double>(count) / counts.runs; };
  EXPECT_LE(counts.false_alarms, 5);  // 0.1 % of 600: beyond 5 in one of 1000 such tests
  EXPECT_LE(counts.clean_rejected, 3);
  EXPECT_NEAR(static_cast<double>(counts.inside) / counts.ellipses, 0.95, 0.05);
  EXPECT_GE(share(counts.blunders_named), 0.93);
  EXPECT_GE(share(counts.exchanges_named), 0.97);
  EXPECT_GE(share(counts.exchanges_alone), 0.95);
  EXPECT_GE(share(counts.times_found), 0.95);
  EXPECT_GE(share(counts.times_named), 0.9);
  // Without loops and with sigmas ten times too large control tells what the network is worth: half of what is usual
  // would be 5.
  EXPECT_LE(counts.unlooped_rejected, 3);
  EXPECT_GE(static_cast<double>(counts.unlooped_inside) / counts.ellipses, 0.93);
  EXPECT_LT(std::sqrt(counts.unlooped_variance / counts.unlooped_squared_error), 1.8);
}

}  // namespace
}  // namespace survey
