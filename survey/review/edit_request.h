// SPDX-License-Identifier: Apache-2.0
//
// Questions about map edits: those that could not follow the map well, or that newer scans contradict. A person keeps
// the edit where it lies, puts it back or draws it anew (a new revision, tied to the map as it is now), or retires it;
// each settles the question.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "survey/edits/block_edits.h"
#include "survey/review/request_list.h"

namespace survey {

struct EditRequest {
  std::string block;  // in which it is worst
  AppliedEdit applied;
  std::vector<RequestCause> causes;  // the largest first; named as the findings
  double score_m = 0.0;              // root of the sum of their squares
};

// Each edit once, in order of uids.
std::vector<EditRequest> MakeEditRequests(std::span<const BlockEdits> doubtful);

}  // namespace survey
