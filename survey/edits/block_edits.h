// SPDX-License-Identifier: Apache-2.0
//
// What the edits of a site did to the map of one block.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "survey/edits/map_edit.h"

namespace survey {

struct AppliedEdit {
  MapEdit edit;                                       // its parts where the block's solution puts them
  std::vector<std::vector<Eigen::Vector2d>> drawn{};  // the parts as drawn, where scans have moved them
  std::int64_t changed_cells = 0;                     // of the map, when it was applied
  int vertices = 0;
  int anchored = 0;          // vertices that hang on a scan of the block
  int lost = 0;              // vertices that hung on a scan that is gone
  double shift_m = 0.0;      // farthest that a vertex has moved since it was drawn
  double residual_m = 0.0;   // what is left of that after a rigid fit, the largest
  double area_change = 0.0;  // of an area, relative
};

inline MapEdit AsDrawn(const AppliedEdit& applied) {
  MapEdit edit = applied.edit;
  if (!applied.drawn.empty()) edit.parts = applied.drawn;
  return edit;
}

// What a person should look at. Of the last two he may say what is to become of the edit, so they are asked
// (survey/review/edit_request.h); a conflict stops the run.
enum class FindingKind {
  kConflict,    // two people say opposite things of the same place
  kStale,       // newer scans speak against the edit
  kEditReview,  // the edit could not follow the map well
};

constexpr std::string_view Name(FindingKind kind) {
  switch (kind) {
    case FindingKind::kConflict:
      return "conflict";
    case FindingKind::kStale:
      return "stale";
    case FindingKind::kEditReview:
      return "edit_review";
  }
  return "";
}

struct EditFinding {
  FindingKind kind = FindingKind::kEditReview;
  std::vector<std::string> uids;
  std::string message;  // for people
  double size_m = 0.0;  // by how much the edit may be off; of a conflict 0
};

struct BlockEdits {
  std::string block;
  std::vector<AppliedEdit> edits;  // in the order in which they were applied
  std::vector<EditFinding> findings;
  std::int64_t edited_cells = 0;  // of the map that differ from the grid
};

}  // namespace survey
