// SPDX-License-Identifier: Apache-2.0
//
// A person's answers as observations of the block adjustment: the pose of a scan relative to another one or in the
// site, the relation of two walls; never under a robust loss. What a wrong answer bends is not hidden but told: every
// answer is tested against the rest.
#pragma once

#include <vector>

#include "survey/graph/block_graph.h"
#include "survey/submaps/answer.h"

namespace survey {

// What became of one answer.
struct AnswerTest {
  std::string name;
  ScanId scan;
  double chi_square = 0.0;  // of what the rest says at its place against it
  double limit = 0.0;       // 99.73 % of its degrees of freedom
  bool in_conflict = false;
  std::string not_used;  // why
};

AnswerTest JudgeAnswer(const Answer& answer, double chi_square, int degrees_of_freedom);

// What there is to report, or nothing.
std::string SentenceOn(const AnswerTest& test);

// The first relation that two walls cannot hold, `poses` being those of all scans; empty when there is none.
std::string ProblemWithWalls(const Answers& answers, const std::vector<Pose2>& poses);

// Lets go or widens the observations that lead across rejected stretches, then adds an edge for each answer with a
// relative pose and the walls of each relation. Returns the index of the first of these edges; edges and walls stand in
// the order of the answers.
std::size_t AddAnswers(const Track& track, const Answers& answers, BlockGraph* block);

// Those of AddAnswers, after the adjustment: each against all the rest, r' (Q_rr)^-1 r [Baarda68], so that one that has
// bent the rest to itself is found, too; of walls their residuals. Three degrees of freedom, or as many as a relation
// has. A wrong answer bends right ones: where several are in conflict the worst is named, with those half as bad, since
// any of these may be the wrong one, and the others are tested without them, and so on.
std::vector<AnswerTest> TestAnswers(const Answers& answers, const BlockGraph& block, std::size_t first_edge,
                                    const PoseGraphOptions& options);

}  // namespace survey
