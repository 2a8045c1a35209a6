// SPDX-License-Identifier: Apache-2.0
//
// The edits of all blocks seen together.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "survey/accuracy/edit_summary.h"
#include "survey/edits/block_edits.h"

namespace survey {

enum class EditState {
  kActive,
  kStale,   // active, but newer scans speak against it
  kRetired  // taken back
};

constexpr std::string_view Name(EditState state) {
  switch (state) {
    case EditState::kActive:
      return "active";
    case EditState::kStale:
      return "stale";
    case EditState::kRetired:
      return "retired";
  }
  return "";
}

// An edit on the site's map.
struct SiteEdit {
  AppliedEdit applied;
  EditState state = EditState::kActive;
  std::string remark;  // what is to be looked at; of a retired edit who took it back, when and why
};

// Each edit once, in order of uids, where the block puts it in which most of its vertices hang on scans.
std::vector<SiteEdit> SiteEdits(std::span<const BlockEdits> blocks);

// Of these the areas that robots keep out of.
std::vector<MapEdit> ForbiddenAreas(std::span<const BlockEdits> blocks);

EditSummary SummarizeEdits(std::span<const BlockEdits> blocks);

}  // namespace survey
