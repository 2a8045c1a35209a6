// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/answer_factors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "survey/graph/graph_covariance.h"
#include "survey/graph/graph_residuals.h"
#include "survey/graph/variance_components.h"
#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

// 99.73 % of chi-square, by degrees of freedom.
constexpr std::array kChiSquare = {0.0, 9.0, 11.83, 14.16};

// What odometry alone gets wrong over a rejected stretch.
constexpr double kRejectedSigma_m = 1.0;
constexpr double kRejectedSigma_rad = 0.3;

const Pose2& Tracked(const Track& track, ScanId scan) {
  return track.scans[static_cast<std::size_t>(scan.value)].local_from_scan;
}

ScanId NodeOfPose(const BlockGraph& block, int pose) {
  return block.nodes[static_cast<std::size_t>(pose) - block.num_submaps];
}

// A node behind the begin of the stretch in a submap that was begun before.
bool SpansStretch(const PoseEdge& edge, const Track& track, const BlockGraph& block, const Answer& stretch) {
  const auto num_submaps = static_cast<int>(block.num_submaps);
  if (edge.robust || edge.base >= num_submaps || edge.target < num_submaps) return false;
  const Submap& submap = track.submaps[static_cast<std::size_t>(edge.base)];
  return submap.nodes.front() < stretch.scan && !(NodeOfPose(block, edge.target) < stretch.scan);
}

bool MovesInStretch(const PoseEdge& edge, const BlockGraph& block, const Answer& stretch) {
  const auto num_submaps = static_cast<int>(block.num_submaps);
  if (edge.robust || edge.base < num_submaps || edge.target < num_submaps) return false;
  return !(NodeOfPose(block, edge.target) < stretch.scan) && !(stretch.end < NodeOfPose(block, edge.base));
}

// The many nodes of a submap would together hold what each of them holds weakly, so those that span the stretch are let
// go; the motions in it stay, with the sigmas of odometry.
void RejectStretch(const Track& track, const Answer& stretch, BlockGraph* block) {
  std::erase_if(block->graph.edges, [&](const PoseEdge& edge) { return SpansStretch(edge, track, *block, stretch); });
  const Eigen::Vector3d sigma(kRejectedSigma_m, kRejectedSigma_m, kRejectedSigma_rad);
  for (PoseEdge& edge : block->graph.edges) {
    if (MovesInStretch(edge, *block, stretch)) edge.covariance.diagonal() += sigma.cwiseAbs2();
  }
}

PoseEdge EdgeOf(const Track& track, const Answer& answer, const BlockGraph& block) {
  const ScanId base = NodeNear(block, answer.reference);
  const ScanId target = NodeNear(block, answer.scan);
  const Pose2 base_from_reference = Between(Tracked(track, base), Tracked(track, answer.reference));
  const Pose2 scan_from_target = Between(Tracked(track, answer.scan), Tracked(track, target));
  const Eigen::Matrix3d covariance = answer.sigma.cwiseAbs2().asDiagonal();
  return {block.PoseOf(base),
          block.PoseOf(target),
          base_from_reference * answer.reference_from_scan * scan_from_target,
          RotatedCovariance(covariance, base_from_reference.theta),
          false,
          EdgeKind::kAnswer};
}

WallEdge WallsOf(const Track& track, const Answer& answer, const BlockGraph& block) {
  const ScanId base = NodeNear(block, answer.reference);
  const ScanId target = NodeNear(block, answer.scan);
  WallPair walls = *answer.walls;
  walls.in_base = Between(Tracked(track, base), Tracked(track, answer.reference)) * walls.in_base;
  walls.in_target = Between(Tracked(track, target), Tracked(track, answer.scan)) * walls.in_target;
  return {block.PoseOf(base), block.PoseOf(target), walls, answer.wall_sigma};
}

// Chi-square of an answered pose against the rest.
double AgainstTheRest(const PoseEdge& answer, const PoseGraph& graph, const GraphCovariance& covariance) {
  constexpr double kUncontrolled = 1e-4;  // redundancy that is rounding
  const auto pose = [&](int index) { return graph.poses[static_cast<std::size_t>(index)]; };
  const Eigen::Vector3d error =
      EvaluateRelativePose(pose(answer.base), pose(answer.target), answer.base_from_target).error;
  return SquaredMahalanobis(error, covariance.OfResidual(answer) + kUncontrolled * answer.covariance);
}

// Of all answers that observe something, in their order.
std::vector<AnswerTest> TestEach(const Answers& answers, PoseGraph graph, std::size_t first_edge) {
  FreezeRobustWeights(&graph);
  const auto covariance = GraphCovariance::Of(graph);
  if (!covariance) return {};
  std::vector<AnswerTest> tests;
  auto edge = graph.edges.begin() + static_cast<std::ptrdiff_t>(first_edge);
  auto walls = graph.walls.begin();
  for (const Answer& answer : answers) {
    if (answer.HasRelativePose()) tests.push_back(JudgeAnswer(answer, AgainstTheRest(*edge++, graph, *covariance), 3));
    if (!answer.walls) continue;
    const WallEdge& known = *walls++;
    const double chi_square =
        SquaredNormalisedResidual(known.walls, known.sigma, graph.poses[static_cast<std::size_t>(known.base)],
                                  graph.poses[static_cast<std::size_t>(known.target)]);
    tests.push_back(JudgeAnswer(answer, chi_square, known.walls.Rows()));
  }
  return tests;
}

// Of those in conflict that are not named yet the worst, and those half as bad.
std::vector<std::size_t> Worst(const std::vector<AnswerTest>& tests, const std::vector<bool>& named) {
  double largest = 0.0;
  const auto open = [&](std::size_t i) { return tests[i].in_conflict && !named[i]; };
  const auto size = [&](std::size_t i) { return tests[i].chi_square / tests[i].limit; };
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (open(i)) largest = std::max(largest, size(i));
  }
  std::vector<std::size_t> worst;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (open(i) && size(i) >= 0.5 * largest) worst.push_back(i);
  }
  return worst;
}

// The answer of a test observes nothing any more.
void LetGo(const Answers& answers, std::size_t test, std::size_t first_edge, PoseGraph* graph) {
  constexpr double kNothing = 1e4;  // times its sigmas
  std::size_t edge = first_edge;
  std::size_t walls = 0;
  for (const Answer& answer : answers) {
    if (!answer.HasRelativePose() && !answer.walls) continue;
    if (test-- > 0) {
      ++(answer.walls ? walls : edge);
    } else {
      if (answer.walls) graph->walls[walls].sigma *= kNothing;
      if (!answer.walls) graph->edges[edge].covariance *= kNothing * kNothing;
      return;
    }
  }
}

}  // namespace

AnswerTest JudgeAnswer(const Answer& answer, double chi_square, int degrees_of_freedom) {
  const double limit = kChiSquare[static_cast<std::size_t>(degrees_of_freedom)];
  return {answer.name, answer.scan, chi_square, limit, chi_square > limit, ""};
}

std::string SentenceOn(const AnswerTest& test) {
  char numbers[80];
  std::snprintf(numbers, sizeof numbers, " (chi-square %.1f, limit %.1f)", test.chi_square, test.limit);
  const std::string name = "answer " + test.name;
  if (!test.not_used.empty()) return name + " was not used: " + test.not_used + (test.in_conflict ? numbers : "");
  return test.in_conflict ? name + ": in conflict with the other observations" + numbers : "";
}

std::string ProblemWithWalls(const Answers& answers, const std::vector<Pose2>& poses) {
  for (const Answer& answer : answers) {
    if (!answer.walls) continue;
    const Pose2& base = poses[static_cast<std::size_t>(answer.reference.value)];
    const Pose2& target = poses[static_cast<std::size_t>(answer.scan.value)];
    if (MayHold(*answer.walls, base, target)) continue;
    char angle[40];
    std::snprintf(angle, sizeof angle, "%.0f",
                  std::abs(EvaluateWalls(*answer.walls, base, target).error.y()) * 57.2957795);
    return "answer " + answer.name + ": relation = " + std::string(Name(answer.walls->relation)) +
           ": the two walls are " + angle + " degrees off that in the map, more than 30: they cannot hold it";
  }
  return "";
}

std::size_t AddAnswers(const Track& track, const Answers& answers, BlockGraph* block) {
  for (const Answer& answer : answers) {
    if (answer.decision == Decision::kRejectStretch) RejectStretch(track, answer, block);
  }
  const std::size_t first = block->graph.edges.size();
  for (const Answer& answer : answers) {
    if (answer.HasRelativePose()) block->graph.edges.push_back(EdgeOf(track, answer, *block));
    if (answer.walls) block->graph.walls.push_back(WallsOf(track, answer, *block));
  }
  return first;
}

std::vector<AnswerTest> TestAnswers(const Answers& answers, const BlockGraph& block, std::size_t first_edge,
                                    const PoseGraphOptions& options) {
  if (std::none_of(answers.begin(), answers.end(), [](const Answer& a) { return a.ActsInFilter(); })) return {};
  std::vector<AnswerTest> tests = TestEach(answers, block.graph, first_edge);
  const auto num_conflicts =
      std::count_if(tests.begin(), tests.end(), [](const auto& test) { return test.in_conflict; });
  if (num_conflicts < 2) return tests;
  PoseGraph rest = block.graph;
  std::vector<bool> named(tests.size(), false);
  while (true) {
    const std::vector<std::size_t> worst = Worst(tests, named);
    if (worst.empty()) break;
    for (const std::size_t i : worst) {
      named[i] = true;
      LetGo(answers, i, first_edge, &rest);
    }
    if (!Solve(&rest, options).usable) break;
    const std::vector<AnswerTest> without = TestEach(answers, rest, first_edge);
    for (std::size_t i = 0; i < without.size(); ++i) {
      if (!named[i]) tests[i] = without[i];
    }
  }
  return tests;
}

}  // namespace survey
