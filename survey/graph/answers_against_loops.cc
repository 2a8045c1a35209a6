// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/answers_against_loops.h"

#include <algorithm>

#include "survey/graph/loop_consistency.h"

namespace survey {
namespace {

constexpr double kContradicted3 = 14.16;  // 99.73 %, three degrees of freedom
constexpr double kSameStory_m = 0.5;

const Pose2& PoseOf(const PoseGraph& graph, int pose) { return graph.poses[IndexOf(pose)]; }

bool Contradicted(const PoseEdge& answer, const PoseGraph& graph) {
  return SquaredNormalisedResidual(answer, graph.poses) > kContradicted3;
}

std::ptrdiff_t NumContradicted(const PoseGraph& graph, std::size_t first_answer) {
  return std::count_if(graph.edges.begin() + static_cast<std::ptrdiff_t>(first_answer), graph.edges.end(),
                       [&](const PoseEdge& answer) { return Contradicted(answer, graph); });
}

// How an answer would move its scan, and all that is displaced with it.
Pose2 MotionBy(const PoseEdge& answer, const PoseGraph& graph) {
  return PoseOf(graph, answer.base) * answer.base_from_target * Inverse(PoseOf(graph, answer.target));
}

bool TellTheSame(const PoseEdge& first, const PoseEdge& second, const PoseGraph& graph) {
  const auto apart = [&](int pose) {
    const Eigen::Vector2d place = PoseOf(graph, pose).Translation();
    return (MotionBy(first, graph) * place - MotionBy(second, graph) * place).norm();
  };
  return std::max(apart(first.target), apart(second.target)) < kSameStory_m;
}

// Two answers that say the same against the loops alone, one of them even after it has been observed.
bool TwoAgree(const PoseGraph& solved, const PoseGraph& free, std::size_t first_answer) {
  for (std::size_t i = first_answer; i < solved.edges.size(); ++i) {
    const PoseEdge& denied = solved.edges[i];
    if (!Contradicted(denied, solved) || !Contradicted(denied, free)) continue;
    for (std::size_t j = first_answer; j < solved.edges.size(); ++j) {
      const PoseEdge& other = solved.edges[j];
      if (j != i && Contradicted(other, free) && TellTheSame(denied, other, free)) return true;
    }
  }
  return false;
}

// Poses and points as they are without loops.
bool StartWithoutLoops(PoseGraphOptions options, PoseGraph* graph) {
  PoseGraph without = *graph;
  std::erase_if(without.edges, IsLoop);
  options.chordal_start = true;
  if (!Solve(&without, options).usable) return false;
  graph->poses = without.poses;
  graph->points = without.points;
  return true;
}

}  // namespace

std::optional<FreedSolution> FollowAnswersAgainstLoops(std::size_t first_answer, const std::vector<Pose2>& free_poses,
                                                       double factor_of_loops, const PoseGraphOptions& options,
                                                       BlockGraph* block) {
  PoseGraph graph = block->graph;
  graph.poses = free_poses;
  if (!TwoAgree(block->graph, graph, first_answer)) return std::nullopt;
  if (!StartWithoutLoops(options, &graph) || !Solve(&graph, options).usable) return std::nullopt;
  // False loops may have widened all of them. The loops stand before the answers.
  const double limit = kFarthestLoop / std::max(1.0, factor_of_loops);
  const std::size_t left_out = std::erase_if(graph.edges, [&](const PoseEdge& edge) {
    return IsLoop(edge) && SquaredNormalisedResidual(edge, graph.poses) > limit;
  });
  const PoseGraphSummary summary = Solve(&graph, options);
  if (!summary.usable || NumContradicted(graph, first_answer - left_out) >= NumContradicted(block->graph, first_answer))
    return std::nullopt;
  block->graph = std::move(graph);
  return FreedSolution{summary, left_out};
}

}  // namespace survey
