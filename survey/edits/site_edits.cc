// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/site_edits.h"

#include <algorithm>
#include <map>

namespace survey {
namespace {

void AddFinding(const EditFinding& finding, SiteEdit* edit) {
  if (finding.kind == FindingKind::kStale) edit->state = EditState::kStale;
  edit->remark += (edit->remark.empty() ? "" : "; ") + finding.message;
}

}  // namespace

std::vector<SiteEdit> SiteEdits(std::span<const BlockEdits> blocks) {
  std::map<std::string, SiteEdit> by_uid;
  for (const BlockEdits& block : blocks) {
    for (const AppliedEdit& applied : block.edits) {
      const auto [place, is_new] = by_uid.try_emplace(applied.edit.uid, SiteEdit{.applied = applied});
      if (!is_new && applied.anchored > place->second.applied.anchored) place->second.applied = applied;
    }
  }
  for (const BlockEdits& block : blocks) {
    for (const EditFinding& finding : block.findings) {
      for (const std::string& uid : finding.uids) {
        if (const auto found = by_uid.find(uid); found != by_uid.end()) AddFinding(finding, &found->second);
      }
    }
  }
  std::vector<SiteEdit> edits;
  for (auto& [uid, edit] : by_uid) edits.push_back(std::move(edit));
  return edits;
}

std::vector<MapEdit> ForbiddenAreas(std::span<const BlockEdits> blocks) {
  std::vector<MapEdit> areas;
  for (const SiteEdit& edit : SiteEdits(blocks)) {
    if (edit.applied.edit.kind == EditKind::kForbidden) areas.push_back(edit.applied.edit);
  }
  return areas;
}

EditSummary SummarizeEdits(std::span<const BlockEdits> blocks) {
  EditSummary summary;
  for (const SiteEdit& site_edit : SiteEdits(blocks)) {
    const MapEdit& edit = site_edit.applied.edit;
    summary.num_edits += StateOf(edit) ? 1 : 0;
    summary.num_forbidden += edit.kind == EditKind::kForbidden ? 1 : 0;
    summary.num_masks += edit.kind == EditKind::kMaskReturns ? 1 : 0;
  }
  for (const BlockEdits& block : blocks) {
    if (block.edits.empty()) continue;
    EditedBlock edited{.block = block.block, .edited_cells = block.edited_cells};
    edited.num_edits = static_cast<int>(block.edits.size());
    for (const AppliedEdit& applied : block.edits) edited.max_shift_m = std::max(edited.max_shift_m, applied.shift_m);
    summary.blocks.push_back(edited);
    for (const EditFinding& finding : block.findings)
      summary.findings.push_back(block.block + ": " + std::string(Name(finding.kind)) + ": " + finding.message);
  }
  return summary;
}

}  // namespace survey
