// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/apply_edits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace survey {
namespace {

// Fewer cells than this overlap by the way people draw.
constexpr int kFewCells = 3;
// Log-odds of three rays through a cell ([CN] eq. (1) with p_miss = 0.45), and their opposite.
constexpr float kEvidence = 0.6F;
constexpr double kStaleShare = 0.5;
// An edit whose scans are all gone may be off by as much as one at a break of the track.
constexpr double kOfLost_m = 1.0;

bool Concerns(const MapEdit& edit, const std::string& block) {
  if (edit.kind == EditKind::kMaskReturns) return edit.beams.contains(block);
  if (edit.kind == EditKind::kAdjust) return edit.anchors.contains(block);
  const bool drawn_elsewhere = !edit.anchors.empty() && edit.basis.contains(block) && !edit.anchors.contains(block);
  return edit.frame == EditFrame::kSite || !drawn_elsewhere;
}

int RankOf(const MapEdit& edit) {
  const std::optional<CellState> state = StateOf(edit);
  if (!state) return 2;
  return *state == CellState::kOccupied ? 1 : 0;
}

bool Supersedes(const MapEdit& a, const MapEdit& b) {
  return std::find(a.supersedes.begin(), a.supersedes.end(), b.uid) != a.supersedes.end();
}

bool Contradict(const MapEdit& a, const MapEdit& b) {
  const bool opposite = (StateOf(a) == CellState::kOccupied) != (StateOf(b) == CellState::kOccupied);
  return opposite && a.who != b.who && !Supersedes(a, b) && !Supersedes(b, a);
}

std::string Titled(const MapEdit& edit) {
  return std::string(Name(edit.kind)) + " " + edit.uid + " (" + edit.who + ", " + edit.when + ")";
}

// Applies edits in order and remembers whose the cells are.
class MapEditor {
 public:
  MapEditor(const std::vector<AppliedEdit>& edits, SiteRaster* grid)
      : edits_(edits), grid_(grid), owners_(grid->log_odds.size(), -1) {}

  std::int64_t Apply(std::size_t index) {
    const MapEdit& edit = edits_[index].edit;
    if (!StateOf(edit)) return 0;
    ForEachCell(edit, *grid_, [&](int column, int row) {
      int& owner = owners_[grid_->Index(column, row)];
      if (owner >= 0 && Contradict(edits_[static_cast<std::size_t>(owner)].edit, edit))
        ++overlaps_[{owner, static_cast<int>(index)}];
      owner = static_cast<int>(index);
    });
    return ApplyEdit(edit, grid_);
  }

  std::vector<EditFinding> Conflicts() const {
    std::vector<EditFinding> findings;
    for (const auto& [pair, cells] : overlaps_) {
      if (cells < kFewCells) continue;
      const MapEdit& first = edits_[static_cast<std::size_t>(pair.first)].edit;
      const MapEdit& second = edits_[static_cast<std::size_t>(pair.second)].edit;
      findings.push_back(
          {FindingKind::kConflict,
           {first.uid, second.uid},
           Titled(first) + " and " + Titled(second) + " contradict each other in " + std::to_string(cells) + " cells",
           0.0});
    }
    return findings;
  }

 private:
  const std::vector<AppliedEdit>& edits_;
  SiteRaster* grid_;
  std::vector<int> owners_;  // by cell: the edit that set it last
  std::map<std::pair<int, int>, int> overlaps_;
};

// Share of the observed cells of an edit in which the grid clearly says otherwise.
std::pair<int, int> EvidenceAgainst(const MapEdit& edit, const SiteRaster& grid) {
  int observed = 0;
  int against = 0;
  const bool occupied = StateOf(edit) == CellState::kOccupied;
  ForEachCell(edit, grid, [&](int column, int row) {
    const float log_odds = grid.At(column, row);
    if (std::isnan(log_odds)) return;
    ++observed;
    against += (occupied ? log_odds <= -kEvidence : log_odds >= kEvidence) ? 1 : 0;
  });
  return {against, observed};
}

// Scans of a block that had no map when the edit was drawn are newer than it.
void FindStale(const std::string& block, const MapEdit& edit, const SiteRaster& grid,
               std::vector<EditFinding>* findings) {
  const std::optional<CellState> state = StateOf(edit);
  if (!state || *state == CellState::kUnknown || edit.basis.contains(block)) return;
  const auto [against, observed] = EvidenceAgainst(edit, grid);
  // A drawn wall is a line through free space; a few hits are enough to say that an erased place is taken again.
  const double share = *state == CellState::kOccupied ? kStaleShare : 0.0;
  if (against < kFewCells || against < share * observed) return;
  findings->push_back({FindingKind::kStale,
                       {edit.uid},
                       Titled(edit) + ": the newer scans of " + block + " contradict it in " + std::to_string(against) +
                           " of " + std::to_string(observed) + " cells",
                       static_cast<double>(against) / observed});
}

void FindPoorRefit(const AppliedEdit& applied, const RefitLimits& limits, std::vector<EditFinding>* findings) {
  if (applied.edit.kind == EditKind::kMaskReturns) return;  // its beams hold whatever becomes of the poses
  char reason[160] = "";
  double size_m = applied.residual_m;
  if (applied.lost > 0) {
    std::snprintf(reason, sizeof reason, "the scans under %d of %d vertices are gone", applied.lost, applied.vertices);
    size_m = std::max(size_m, kOfLost_m * applied.lost / applied.vertices);
  } else if (applied.residual_m > limits.residual_m) {
    std::snprintf(reason, sizeof reason, "the map under it was bent by %.2f m", applied.residual_m);
  } else if (std::abs(applied.area_change) > limits.area_change) {
    std::snprintf(reason, sizeof reason, "its area changed by %+.0f %%", 100.0 * applied.area_change);
  } else {
    return;
  }
  findings->push_back({FindingKind::kEditReview, {applied.edit.uid}, Titled(applied.edit) + ": " + reason, size_m});
}

std::int64_t CountDifferent(const std::vector<float>& a, const std::vector<float>& b) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])) ? 0 : 1;
  return count;
}

}  // namespace

std::vector<AppliedEdit> EditsOfBlock(const std::string& block, const std::vector<MapEdit>& edits,
                                      const BlockPoses& poses) {
  std::vector<AppliedEdit> concerned;
  for (const MapEdit& edit : edits) {
    if (!Concerns(edit, block)) continue;
    const auto anchors = edit.anchors.find(block);
    const bool moves = edit.frame == EditFrame::kMap && anchors != edit.anchors.end();
    concerned.push_back(moves ? MovedWithScans(edit, anchors->second, poses)
                              : AppliedEdit{.edit = edit, .vertices = static_cast<int>(NumVertices(edit))});
  }
  std::sort(concerned.begin(), concerned.end(), [](const AppliedEdit& a, const AppliedEdit& b) {
    return std::tuple(RankOf(a.edit), a.edit.when, a.edit.uid) < std::tuple(RankOf(b.edit), b.edit.when, b.edit.uid);
  });
  return concerned;
}

SiteRaster PartUnder(const std::vector<AppliedEdit>& edits, const RasterStrips& grid) {
  const double cell_size_m = grid.frame.cell_size_m;
  if (edits.empty()) return {.cell_size_m = cell_size_m};
  CellBox box = BoxOf(edits.front().edit, cell_size_m);
  for (const AppliedEdit& applied : edits) box = Hull(box, BoxOf(applied.edit, cell_size_m));
  return PartOf(grid, box, 0);
}

BlockEdits ApplyEdits(const std::string& block, std::vector<AppliedEdit> edits, const RefitLimits& limits,
                      SiteRaster* grid) {
  BlockEdits result{.block = block, .edits = std::move(edits)};
  if (result.edits.empty()) return result;
  const std::vector<float> before = grid->log_odds;
  for (const AppliedEdit& applied : result.edits) {
    FindStale(block, applied.edit, *grid, &result.findings);
    FindPoorRefit(applied, limits, &result.findings);
  }
  MapEditor editor(result.edits, grid);
  for (std::size_t i = 0; i < result.edits.size(); ++i) result.edits[i].changed_cells = editor.Apply(i);
  for (EditFinding& conflict : editor.Conflicts()) result.findings.push_back(std::move(conflict));
  result.edited_cells = CountDifferent(before, grid->log_odds);
  return result;
}

BlockEdits Doubtful(const BlockEdits& edits) {
  BlockEdits doubtful{.block = edits.block};
  std::set<std::string> uids;
  for (const EditFinding& finding : edits.findings) {
    if (finding.kind == FindingKind::kConflict) continue;
    doubtful.findings.push_back(finding);
    uids.insert(finding.uids.front());
  }
  for (const AppliedEdit& applied : edits.edits) {
    if (uids.contains(applied.edit.uid)) doubtful.edits.push_back(applied);
  }
  return doubtful;
}

}  // namespace survey
