// SPDX-License-Identifier: Apache-2.0
//
// A person's answers as observations of the block adjustment: the pose of a scan relative to another one, never under a
// robust loss. What a wrong answer bends is not hidden but told: every answer is tested against the rest.
#pragma once

#include <vector>

#include "survey/graph/block_graph.h"
#include "survey/submaps/answer.h"

namespace survey {

// What became of one answer.
struct AnswerTest {
  std::string name;
  ScanId scan;
  double chi_square = 0.0;  // of its residuals after the adjustment, three degrees of freedom
  bool in_conflict = false;
};

// Lets go or widens the observations that lead across rejected stretches, then adds an edge for each answer with a
// pose. Returns the index of the first of these edges; they stand in the order of the answers.
std::size_t AddAnswers(const Track& track, const Answers& answers, BlockGraph* block);

// After the adjustment.
std::vector<AnswerTest> TestAnswers(const Answers& answers, const BlockGraph& block, std::size_t first_edge);

}  // namespace survey
