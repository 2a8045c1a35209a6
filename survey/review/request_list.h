// SPDX-License-Identifier: Apache-2.0
//
// Questions for a person: doubts of a block that lie together on the path make one, about the scan of the largest. What
// a person can say at a desk is how a scan lies against what an earlier pass saw, so each question names a scan of one.
#pragma once

#include <optional>
#include <vector>

#include "survey/review/doubt.h"
#include "survey/submaps/answer.h"

namespace survey {

struct RequestOptions {
  double least_doubt_m = 0.05;   // smaller doubts are not asked
  double together_m = 2.0;       // doubts nearer on the path than this make one request,
  double longest_m = 15.0;       // which gets no longer than this
  double earlier_pass_m = 15.0;  // path to an earlier pass, at least
  double in_view_m = 4.0;        // distance to it, at most
};

// 1 sigma of a pose by the adjustment: along and across the way (m), heading (rad).
struct PoseSpread {
  double along = 0.0;
  double across = 0.0;
  double heading = 0.0;
};

struct RequestReference {
  ScanId scan;
  bool earlier_pass = false;  // else the last scan before the stretch
};

struct RequestCause {
  std::string cause;
  double size_m = 0.0;
  std::string message;
};

struct Request {
  ScanId scan;
  ScanRange stretch;
  std::vector<RequestCause> causes;  // each once, the largest first
  double score_m = 0.0;              // root of the sum of their squares
  std::vector<PoseMode> modes;       // of `scan`, the most likely first
  std::optional<PoseSpread> spread;
  std::optional<RequestReference> reference;
  std::optional<std::size_t> answer;  // index of the answer for a scan of the stretch
};

// In order of their stretches.
std::vector<Request> MakeRequests(const std::vector<Doubt>& doubts, const Solution& solution, const Answers& answers,
                                  const RequestOptions& options);

}  // namespace survey
