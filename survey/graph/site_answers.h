// SPDX-License-Identifier: Apache-2.0
//
// Answers that give the pose of a scan in the site. They come last and control wins: one that contradicts the block's
// control points, by its sigma, the covariances and what a track may drift on its way from them, is left out.
#pragma once

#include <vector>

#include "survey/graph/answer_factors.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/solution.h"

namespace survey {

// Where the block stands after the adjustment with control.
struct SiteDatum {
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // graph frame plus offset is the site frame
  std::vector<ScanId> on_control;                    // scans of the used marks
};

// Those that agree with control become edges from the site's origin, a further pose at the end of the graph, which is
// held. Returns tests of the others.
std::vector<AnswerTest> AddSiteAnswers(const Track& track, const Answers& answers, const SiteDatum& datum,
                                       const GraphCovariance& covariance, BlockGraph* block);

// Of the edges that were added, after the adjustment with them.
std::vector<AnswerTest> TestSiteAnswers(const Answers& answers, const std::vector<AnswerTest>& left_out,
                                        const BlockGraph& block, std::size_t first_edge);

// Of a block that two control points do not tie: none is used.
std::vector<AnswerTest> UnusedSiteAnswers(const Answers& answers);

// Names an answer that lies nowhere near the way of the block; empty when there is none.
std::string AnswerOutsideMap(const Answers& answers, const std::vector<SolvedScan>& scans);

}  // namespace survey
