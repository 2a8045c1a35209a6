// SPDX-License-Identifier: Apache-2.0
//
// Doubts and requests on a way of two laps around a square, 10 m a side, a scan every 0.1 m.
#include "survey/review/request_list.h"

#include <gtest/gtest.h>

namespace survey {
namespace {

constexpr int kScansOfLap = 400;

Pose2 OnSquare(int scan) {
  const int side = scan / 100 % 4;
  const double along = 0.1 * (scan % 100);
  const Eigen::Vector2d corners[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const double heading = side * std::numbers::pi / 2.0;
  const Eigen::Vector2d p = corners[side] + along * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  return {p.x(), p.y(), NormalizeAngle(heading)};
}

struct TwoLaps : public testing::Test {
  TwoLaps() {
    for (int i = 0; i < 2 * kScansOfLap; ++i) {
      track.scans.push_back({.scan = {i}, .local_from_scan = OnSquare(i), .matched = true});
      solution.scans.push_back({{i}, OnSquare(i), true});
      stamps.push_back(1000 * i);
    }
    track.submaps = {{{0}, {}, {{0}}}};
    solution.submaps = {{{0}, {}}};
  }
  std::vector<Doubt> Doubts() const { return FindDoubts({track, loops, solution, stamps, conflicts}); }
  std::vector<Request> Requests(const Answers& answers = {}) const {
    return MakeRequests(Doubts(), solution, answers, {});
  }

  Track track;
  Loops loops;
  Solution solution;
  std::vector<StampNs> stamps;
  std::vector<PassConflict> conflicts;
};

TEST_F(TwoLaps, NothingToDoubtNothingToAsk) { EXPECT_TRUE(Requests().empty()); }

TEST_F(TwoLaps, AStretchWithoutMatchesIsAsLongAsItsScansAndDriftsWithItsWay) {
  for (std::size_t i = 500; i < 540; ++i) {
    track.scans[i].matched = false;
    track.scans[i].prediction = Prediction::kOdometry;
  }
  track.requests = {{{500}, "odometry_only", 4.0, "40 scans without a match"}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].stretch.first.value, 500);
  EXPECT_EQ(requests[0].stretch.last.value, 539);
  EXPECT_NEAR(requests[0].score_m, 0.05 * 4.0, 1e-9);
}

TEST_F(TwoLaps, AGapOfTheScansDriftsWithTheWayOverIt) {
  track.scans[500].prediction = Prediction::kOdometry;
  track.scans[499].local_from_scan = track.scans[500].local_from_scan * Pose2{-4.0, 0.0, 0.0};
  track.requests = {{{500}, "odometry_only", 4.0, "no scan for 4.0 s, bridged by odometry"}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_NEAR(requests[0].score_m, 0.05 * 4.0, 1e-9);
}

TEST_F(TwoLaps, DoubtsThatLieTogetherMakeOneRequestAboutTheLargest) {
  track.requests = {{{600}, "neff", 0.3, "a"},
                    {{610}, "neff", 0.2, "b"},
                    {{615}, "break", 7.0, "c"},
                    {{700}, "neff", 0.2, "d"},
                    {{760}, "neff", 0.01, "too small"}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[0].scan.value, 615);
  ASSERT_EQ(requests[0].causes.size(), 2U);
  EXPECT_EQ(requests[0].causes[0].cause, "break");
  EXPECT_EQ(requests[0].causes[1].message, "a");
  EXPECT_NEAR(requests[0].score_m, std::hypot(1.0, 0.3), 1e-9);
  EXPECT_EQ(requests[1].scan.value, 700);
}

TEST_F(TwoLaps, ARequestRefersToAnEarlierPassWhereThereIsOneElseToTheScansBefore) {
  track.requests = {{{200}, "break", 1.0, ""}, {{630}, "break", 1.0, ""}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_FALSE(requests[0].reference->earlier_pass);
  EXPECT_EQ(requests[0].reference->scan.value, 190);  // 1 m before
  EXPECT_TRUE(requests[1].reference->earlier_pass);
  EXPECT_EQ(requests[1].reference->scan.value, 630 - kScansOfLap);
}

TEST_F(TwoLaps, ARejectedLoopOffersItsPoseOneThatAgreesDoesNot) {
  const auto loop = [&](int scan, double off) {
    const Pose2 pose = OnSquare(scan);
    return Loop{.constraint = {{0}, {scan}, {pose.x + off, pose.y, pose.theta}},
                .score = 0.6,
                .accepted = false,
                .reason = "no neighbour agrees"};
  };
  loops.loops = {loop(500, 0.05), loop(600, 0.8)};
  track.requests = {{{610}, "break", 1.0, ""}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].scan.value, 610);
  ASSERT_EQ(requests[0].modes.size(), 1U);
  EXPECT_NEAR(requests[0].modes[0].site_from_scan.x, OnSquare(610).x + 0.8, 1e-9);  // carried along the way
  EXPECT_NEAR(requests[0].modes[0].site_from_scan.y, OnSquare(610).y, 1e-9);
}

TEST_F(TwoLaps, AConflictOfPassesAsksAgainstTheOtherPass) {
  conflicts = {{{600}, {660}, {180}, {230}, {400, 100}}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].scan.value, 630);
  EXPECT_NEAR(requests[0].score_m, 0.25, 1e-12);
  EXPECT_EQ(requests[0].reference->scan.value, 230);
}

TEST_F(TwoLaps, TheSpreadIsAlongAndAcrossTheWay) {
  NodeCovariance covariance{.scan = {650}};
  covariance.covariance.diagonal() = Eigen::Vector3d(0.04, 0.01, 0.0004);  // the way leads west
  solution.covariances = {covariance};
  track.requests = {{{640}, "break", 1.0, ""}};
  const std::optional<PoseSpread> spread = Requests()[0].spread;
  EXPECT_NEAR(spread->along, 0.2, 1e-9);
  EXPECT_NEAR(spread->across, 0.1, 1e-9);
  EXPECT_NEAR(spread->heading, 0.02, 1e-9);
}

TEST_F(TwoLaps, MarksThatDoNotFitTheirPointsAreAskedAbout) {
  SolvedMark mark{.point = "7", .start_ns = 1000 * 300, .end_ns = 1000 * 310, .scan = {305}};
  mark.residual = {0.3, 0.4};
  mark.left_out = "point 7 is named by mistake";
  solution.marks = {mark, {.point = "8", .scan = {350}, .used = true}};
  const std::vector<Request> requests = Requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].causes[0].cause, "control_residual");
  EXPECT_EQ(requests[0].causes[0].message, mark.left_out);
  EXPECT_NEAR(requests[0].score_m, 0.5, 1e-9);
  EXPECT_EQ(requests[0].stretch.last.value, 310);
}

TEST_F(TwoLaps, AnAnswerForAScanOfTheStretchAnswersTheRequest) {
  conflicts = {{{600}, {660}, {180}, {230}, {400, 100}}};
  const Answers answers = {{.name = "a.json", .scan = {599}}, {.name = "b.json", .scan = {655}}};
  EXPECT_EQ(Requests(answers)[0].answer, 1U);
  EXPECT_FALSE(Requests({answers[0]})[0].answer);
}

}  // namespace
}  // namespace survey
