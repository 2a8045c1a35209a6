// SPDX-License-Identifier: Apache-2.0
#include "survey/review/edit_request.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace survey {
namespace {

EditRequest RequestOf(const BlockEdits& block, const AppliedEdit& applied) {
  EditRequest request{.block = block.block, .applied = applied};
  double squares = 0.0;
  for (const EditFinding& finding : block.findings) {
    if (finding.uids.front() != applied.edit.uid) continue;
    request.causes.push_back({std::string(Name(finding.kind)), finding.size_m, finding.message});
    squares += finding.size_m * finding.size_m;
  }
  std::stable_sort(request.causes.begin(), request.causes.end(),
                   [](const RequestCause& a, const RequestCause& b) { return a.size_m > b.size_m; });
  request.score_m = std::sqrt(squares);
  return request;
}

}  // namespace

std::vector<EditRequest> MakeEditRequests(std::span<const BlockEdits> doubtful) {
  std::map<std::string, EditRequest> by_uid;
  for (const BlockEdits& block : doubtful) {
    for (const AppliedEdit& applied : block.edits) {
      EditRequest request = RequestOf(block, applied);
      const auto [place, is_new] = by_uid.try_emplace(applied.edit.uid, request);
      if (!is_new && request.score_m > place->second.score_m) place->second = std::move(request);
    }
  }
  std::vector<EditRequest> requests;
  for (auto& [uid, request] : by_uid) requests.push_back(std::move(request));
  return requests;
}

}  // namespace survey
