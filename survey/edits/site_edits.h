// SPDX-License-Identifier: Apache-2.0
//
// The edits of all blocks seen together.
#pragma once

#include <span>
#include <vector>

#include "survey/accuracy/edit_summary.h"
#include "survey/edits/block_edits.h"

namespace survey {

// An edit on the site's map, and whether something is to be looked at.
struct SiteEdit {
  AppliedEdit applied;
  bool has_finding = false;
};

// Each edit once, in order of uids, where the block puts it in which most of its vertices hang on scans.
std::vector<SiteEdit> SiteEdits(std::span<const BlockEdits> blocks);

// Of these the areas that robots keep out of.
std::vector<MapEdit> ForbiddenAreas(std::span<const BlockEdits> blocks);

EditSummary SummarizeEdits(std::span<const BlockEdits> blocks);

}  // namespace survey
