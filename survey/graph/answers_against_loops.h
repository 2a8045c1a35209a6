// SPDX-License-Identifier: Apache-2.0
//
// Loops that are wrong in the same way hold each other, and a solution does not come free of them by itself. Answers
// can free it: where two say the same of how the loops displace their scans, and one of them is contradicted although
// it has been observed, the same observations are solved anew from where they are without loops, and loops that
// contradict that solution go. One answer alone does not do it, nor do several of different opinions: they may be the
// ones that are wrong.
#pragma once

#include <optional>
#include <vector>

#include "survey/graph/block_graph.h"

namespace survey {

struct FreedSolution {
  PoseGraphSummary summary;
  std::size_t loops_left_out = 0;
};

// `block`: solved with loops and answers; the edges from `first_answer` on are those of answers, as AddAnswers returned
// it; `free_poses`: of the solution without answers; `factor_of_loops`: that their covariances have been multiplied by.
// When the solution from the other start contradicts fewer answers, the block takes it.
std::optional<FreedSolution> FollowAnswersAgainstLoops(std::size_t first_answer, const std::vector<Pose2>& free_poses,
                                                       double factor_of_loops, const PoseGraphOptions& options,
                                                       BlockGraph* block);

}  // namespace survey
