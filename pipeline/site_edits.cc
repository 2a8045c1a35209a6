// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_edits.h"

#include <algorithm>
#include <limits>

#include "formats/artefacts.h"
#include "formats/block_edits_file.h"
#include "formats/errors.h"
#include "pipeline/descent.h"
#include "pipeline/site_layout.h"
#include "survey/edits/apply_edits.h"
#include "survey/edits/masked_beams.h"
#include "survey/edits/site_edits.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;
using formats::LedgerLine;
using formats::LedgerOperation;
using survey::EditKind;
using survey::MapEdit;

// A vertex at least this often: the map under a line may bend (m).
constexpr double kVertexSpacing_m = 2.0;
// Edges of a map are walls, and people draw on their outer side too (m).
constexpr double kBesideTheMap_m = 1.0;
// A forbidden area may reach beyond the map; an edit wholly out there was drawn in other coordinates (m).
constexpr double kOffTheMap_m = 20.0;

fs::path InBlock(const fs::path& site, const std::string& block, const char* file) {
  return site / "work" / block / file;
}

std::vector<std::string> MappedBlocks(const fs::path& site) {
  std::vector<std::string> blocks = BlocksOf(site);
  std::erase_if(blocks, [&](const std::string& block) { return !fs::exists(InBlock(site, block, "grid.tif")); });
  return blocks;
}

// A block's map with the poses that drew it, read when first needed.
struct BlockMap {
  std::string name;
  survey::SiteRaster grid;
  survey::BlockPoses poses;
};

BlockMap ReadBlockMap(const fs::path& site, const std::string& block) {
  const fs::path grid = InBlock(site, block, "grid.tif");
  const fs::path solution = InBlock(site, block, "solution.sqlite");
  RequireDescent(grid, solution);
  BlockMap map{.name = block, .grid = formats::ReadRaster(grid), .poses = ReadBlockPoses(solution)};
  if (map.grid.drawn_by.empty())
    throw DataError(grid.string() + ": does not tell which scan drew a cell; plumbline run draws it anew");
  return map;
}

std::string TitleOf(const MapEdit& edit) {
  return std::string(Name(edit.kind)) + (edit.uid.empty() ? "" : " " + edit.uid);
}

void RequireOnTheMaps(const MapEdit& edit, const std::vector<BlockMap>& maps) {
  double nearest_m = std::numeric_limits<double>::max();
  for (const BlockMap& map : maps) nearest_m = std::min(nearest_m, survey::DistanceToRaster(edit, map.grid));
  if (nearest_m <= kOffTheMap_m) return;
  throw DataError(TitleOf(edit) + ": lies " + std::to_string(static_cast<std::int64_t>(nearest_m)) +
                  " m outside the map; edits must be in site coordinates (easting, northing)");
}

bool HasAny(const std::vector<std::optional<survey::EditAnchor>>& anchors) {
  return std::any_of(anchors.begin(), anchors.end(), [](const auto& anchor) { return anchor.has_value(); });
}

void Tie(const fs::path& site, const std::vector<BlockMap>& maps, const Basis& basis, MapEdit* edit) {
  if (!edit->basis.empty() && edit->basis != basis)
    throw DataError(TitleOf(*edit) + ": was drawn on a map that has been made anew since; look at it again on the " +
                    "map as it is now");
  edit->basis = basis;
  edit->anchors.clear();
  edit->beams.clear();
  const bool on_map = edit->frame == survey::EditFrame::kMap;
  if (on_map) *edit = survey::Densified(*edit, kVertexSpacing_m);
  RequireOnTheMaps(*edit, maps);
  for (const BlockMap& map : maps) {
    if (survey::DistanceToRaster(*edit, map.grid) > kBesideTheMap_m) continue;
    if (on_map || edit->kind == EditKind::kAdjust) {
      auto anchors = survey::AnchorsOf(*edit, map.grid, map.poses);
      if (HasAny(anchors)) edit->anchors[map.name] = std::move(anchors);
    }
    if (edit->kind != EditKind::kMaskReturns) continue;
    const survey::Session session = formats::ReadSession(InBlock(site, map.name, "session.sqlite"));
    auto beams = survey::BeamsInside(*edit, session, map.poses.site_from_scan);
    if (!beams.empty()) edit->beams[map.name] = std::move(beams);
  }
  if (edit->kind == EditKind::kMaskReturns && edit->beams.empty())
    throw DataError(TitleOf(*edit) + ": no scan has a return from there");
}

// Each edit once, where the solutions of the blocks put it.
std::vector<survey::SiteEdit> PlacedBy(const std::vector<NamedFile>& solutions, const std::vector<MapEdit>& edits) {
  std::vector<survey::BlockEdits> blocks;
  for (const NamedFile& solution : solutions)
    blocks.push_back(
        {.block = solution.name, .edits = survey::EditsOfBlock(solution.name, edits, ReadBlockPoses(solution.file))});
  return survey::SiteEdits(blocks);
}

}  // namespace

fs::path LedgerFile(const fs::path& site) { return site / "edits" / "ledger.jsonl"; }

Basis BasisOf(const fs::path& site) {
  Basis basis;
  for (const std::string& block : MappedBlocks(site))
    basis[block] = formats::ReadProvenance(InBlock(site, block, "solution.sqlite")).Own().Id();
  return basis;
}

survey::BlockPoses ReadBlockPoses(const fs::path& solution) {
  survey::BlockPoses poses;
  for (const survey::SolvedScan& scan : formats::ReadSolution(solution).scans)
    poses.site_from_scan.push_back(scan.site_from_scan);
  poses.stamps = survey::ClockStamps(formats::ReadScanStamps(solution));
  return poses;
}

formats::RasterLabel LabelOfSite(const fs::path& site) {
  formats::RasterLabel label;
  for (const std::string& block : MappedBlocks(site)) {
    formats::OpenRaster(InBlock(site, block, "grid.tif"), &label);
    if (label.tied) return label;
  }
  return label;
}

std::vector<survey::BlockEdits> ReadBlockEdits(const std::vector<NamedFile>& files) {
  std::vector<survey::BlockEdits> blocks;
  for (const NamedFile& file : files) blocks.push_back(formats::ReadBlockEdits(file.file));
  return blocks;
}

std::vector<MapEdit> PlacedEdits(const fs::path& site) {
  std::vector<NamedFile> solutions;
  for (const std::string& block : MappedBlocks(site))
    solutions.push_back({block, InBlock(site, block, "solution.sqlite")});
  std::vector<MapEdit> placed;
  for (const survey::SiteEdit& edit : PlacedBy(solutions, formats::ReadLedger(LedgerFile(site)).Active()))
    placed.push_back(edit.applied.edit);
  return placed;
}

std::vector<survey::SiteEdit> RetiredEdits(const fs::path& ledger, const std::vector<NamedFile>& solutions) {
  std::vector<MapEdit> edits;
  std::map<std::string, std::string> remarks;
  for (const formats::RetiredEdit& retired : formats::ReadLedger(ledger).Retired()) {
    const MapEdit& by = retired.retirement;
    edits.push_back(retired.edit);
    remarks[retired.edit.uid] = "taken back by " + by.who + ", " + by.when + (by.why.empty() ? "" : ": " + by.why);
  }
  std::vector<survey::SiteEdit> placed = PlacedBy(solutions, edits);
  for (survey::SiteEdit& edit : placed) {
    edit.state = survey::EditState::kRetired;
    edit.remark = remarks.at(edit.applied.edit.uid);
  }
  return placed;
}

std::optional<std::string> RecordEdits(const fs::path& site, std::vector<LedgerLine> lines,
                                       const std::optional<std::string>& expected_head) {
  const bool any_drawn = std::any_of(lines.begin(), lines.end(),
                                     [](const LedgerLine& line) { return line.operation != LedgerOperation::kRetire; });
  if (any_drawn) {
    std::vector<BlockMap> maps;
    for (const std::string& block : MappedBlocks(site)) maps.push_back(ReadBlockMap(site, block));
    if (maps.empty()) throw DataError(site.string() + ": there is no map yet to be edited; plumbline run first");
    const Basis basis = BasisOf(site);
    for (LedgerLine& line : lines) {
      if (line.operation != LedgerOperation::kRetire) Tie(site, maps, basis, &line.edit);
    }
  }
  return formats::AppendToLedger(LedgerFile(site), std::move(lines), expected_head);
}

}  // namespace pipeline
