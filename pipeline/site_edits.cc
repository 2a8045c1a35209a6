// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_edits.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "formats/artefacts.h"
#include "formats/block_edits_file.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"
#include "pipeline/descent.h"
#include "pipeline/site_layout.h"
#include "survey/edits/apply_edits.h"
#include "survey/edits/masked_beams.h"
#include "survey/edits/site_edits.h"
#include "survey/submaps/drawn_by.h"

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
// An edit may reach beyond the map; a vertex out there was drawn in other coordinates or slipped (m).
constexpr double kOffTheMap_m = 20.0;

// QGIS and the page keep less (m).
constexpr double kSamePlace_m = 0.001;

fs::path InBlock(const fs::path& site, const std::string& block, const char* file) {
  return site / "work" / block / file;
}

std::vector<std::string> MappedBlocks(const fs::path& site) {
  std::vector<std::string> blocks = BlocksOf(site);
  std::erase_if(blocks, [&](const std::string& block) { return !fs::exists(InBlock(site, block, "grid.tif")); });
  return blocks;
}

// A block's map with the poses that drew it.
struct BlockMap {
  std::string name;
  survey::SiteRaster grid;  // its frame alone until an edit lies there
  survey::BlockPoses poses;
  double max_range_m = survey::WitnessOptions{}.max_range_m;
  fs::path session_file;
  std::optional<survey::Session> session;  // read when first needed

  const survey::Session& Session() {
    if (!session) session = formats::ReadSession(session_file);
    if (session->scans.size() != poses.site_from_scan.size())
      throw DataError(session_file.string() + ": does not have the scans of the map; plumbline run draws it anew");
    return *session;
  }
};

void ReadBlockMap(const fs::path& site, BlockMap* map) {
  const fs::path grid = InBlock(site, map->name, "grid.tif");
  const fs::path solution = InBlock(site, map->name, "solution.sqlite");
  RequireDescent(grid, solution);
  map->grid = formats::ReadRaster(grid);
  map->poses = ReadBlockPoses(solution);
  map->session_file = InBlock(site, map->name, "session.sqlite");
  const auto options = formats::ReadProvenance(grid).Own().options;
  const auto max_range = options.find("max-range-m");
  if (max_range != options.end()) map->max_range_m = formats::ParseNumber(max_range->second).value_or(0.0);
}

// The map under an edit with the scans that drew it.
survey::SiteRaster WitnessedPart(const MapEdit& edit, BlockMap* map) {
  survey::SiteRaster part = survey::PartAround(edit, map->grid);
  survey::FillDrawnBy(map->Session(), map->poses.site_from_scan, {.max_range_m = map->max_range_m}, &part);
  return part;
}

// The maps of a site: where they lie at once, what they show when an edit lies there.
class SiteMaps {
 public:
  explicit SiteMaps(fs::path site) : site_(std::move(site)), basis_(BasisOf(site_)) {
    formats::RasterLabel label;
    for (const auto& [block, id] : basis_)
      maps_.push_back(
          {.name = block, .grid = formats::ReadRasterFrame(InBlock(site_, block, "grid.tif"), &label), .poses = {}});
    if (maps_.empty()) throw DataError(site_.string() + ": there is no map yet to be edited; plumbline run first");
  }

  const fs::path& site() const { return site_; }
  const Basis& basis() const { return basis_; }
  const std::vector<BlockMap>& all() const { return maps_; }

  // Maps that the edit meets, or lies close beside.
  std::vector<BlockMap*> Near(const MapEdit& edit) {
    std::vector<BlockMap*> near;
    for (BlockMap& map : maps_) {
      if (survey::DistanceToRaster(edit, map.grid) > kBesideTheMap_m) continue;
      if (map.grid.log_odds.empty()) ReadBlockMap(site_, &map);
      near.push_back(&map);
    }
    return near;
  }

 private:
  fs::path site_;
  Basis basis_;
  std::vector<BlockMap> maps_;
};

std::string TitleOf(const LedgerLine& line) {
  const std::string title = std::string(Name(line.edit.kind)) + (line.edit.uid.empty() ? "" : " " + line.edit.uid);
  return line.where.empty() ? title : line.where + ": " + title;
}

std::string ExtentOf(const BlockMap& map) {
  const Eigen::Vector2d low = survey::LowCornerOf(map.grid);
  const Eigen::Vector2d high = survey::HighCornerOf(map.grid);
  char text[120];
  std::snprintf(text, sizeof text, " reaches from E %.2f N %.2f to E %.2f N %.2f", low.x(), low.y(), high.x(),
                high.y());
  return "the map of block " + map.name + text;
}

void RequireVertexNear(const LedgerLine& line, const Eigen::Vector2d& vertex, int number, const SiteMaps& maps) {
  const BlockMap* nearest = nullptr;
  double least_m = std::numeric_limits<double>::max();
  for (const BlockMap& map : maps.all()) {
    const double distance_m = survey::DistanceToRaster(vertex, map.grid);
    if (distance_m < least_m) nearest = &map;
    least_m = std::min(least_m, distance_m);
  }
  if (least_m <= kOffTheMap_m) return;
  char text[160];
  std::snprintf(text, sizeof text, ": vertex %d at E %.3f N %.3f lies %.0f m outside the map: ", number, vertex.x(),
                vertex.y(), least_m);
  throw DataError(TitleOf(line) + text + ExtentOf(*nearest) +
                  "; edits must be in site coordinates (easting, northing)");
}

bool CoversACell(const MapEdit& edit, const survey::SiteRaster& grid) {
  bool covers = false;
  survey::ForEachCell(edit, grid, [&](int, int) { covers = true; });
  return covers;
}

// What no map can show is refused: no vertex far away, and a cell at least, of the occupancy or of the keep-out mask.
void RequireOnTheMaps(const LedgerLine& line, const SiteMaps& maps) {
  int number = 0;
  for (const std::vector<Eigen::Vector2d>& part : line.edit.parts) {
    for (const Eigen::Vector2d& vertex : part) RequireVertexNear(line, vertex, ++number, maps);
  }
  if (!StateOf(line.edit) && line.edit.kind != EditKind::kForbidden) return;  // these must find scans
  const auto covers = [&](const BlockMap& map) { return CoversACell(line.edit, map.grid); };
  if (std::any_of(maps.all().begin(), maps.all().end(), covers)) return;
  const BlockMap& nearest = *std::min_element(maps.all().begin(), maps.all().end(), [&](const auto& a, const auto& b) {
    return survey::DistanceToRaster(line.edit, a.grid) < survey::DistanceToRaster(line.edit, b.grid);
  });
  throw DataError(TitleOf(line) + ": lies outside the map and covers none of its cells: " + ExtentOf(nearest));
}

bool HasAny(const std::vector<std::optional<survey::EditAnchor>>& anchors) {
  return std::any_of(anchors.begin(), anchors.end(), [](const auto& anchor) { return anchor.has_value(); });
}

// What the maps tell of the edit: the scans that drew them under its vertices, the beams that a mask drops.
void TieToMaps(bool finds_beams, SiteMaps* maps, MapEdit* edit) {
  const bool hangs = edit->frame == survey::EditFrame::kMap || edit->kind == EditKind::kAdjust;
  for (BlockMap* map : maps->Near(*edit)) {
    if (hangs) {
      auto anchors = survey::AnchorsOf(*edit, WitnessedPart(*edit, map), map->poses);
      if (HasAny(anchors)) edit->anchors[map->name] = std::move(anchors);
    }
    if (!finds_beams) continue;
    auto beams = survey::BeamsInside(*edit, map->Session(), map->poses.site_from_scan);
    if (!beams.empty()) edit->beams[map->name] = std::move(beams);
  }
}

// An arrow begins at what a scan saw.
void RequireTails(const LedgerLine& line) {
  for (std::size_t i = 0; i < line.edit.parts.size(); ++i) {
    const bool held = std::any_of(line.edit.anchors.begin(), line.edit.anchors.end(),
                                  [&](const auto& of_block) { return of_block.second[2 * i].has_value(); });
    if (held) continue;
    const Eigen::Vector2d& tail = line.edit.parts[i].front();
    char text[120];
    std::snprintf(text, sizeof text, ": no scan drew the map at the tail of arrow %d, E %.3f N %.3f",
                  static_cast<int>(i) + 1, tail.x(), tail.y());
    throw DataError(TitleOf(line) + text);
  }
}

bool IsSameMask(const MapEdit& a, const MapEdit& b) {
  const auto same_part = [](const auto& p, const auto& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                      [](const auto& u, const auto& v) { return (u - v).norm() < kSamePlace_m; });
  };
  return a.kind == b.kind && a.from_ns == b.from_ns && a.until_ns == b.until_ns &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same_part);
}

// Of a mask that is revised: the session holds its returns no more, so that its beams stay, and its shape must.
void KeepBeams(const fs::path& site, LedgerLine* line) {
  for (const MapEdit& placed : PlacedEdits(site)) {
    if (placed.uid != line->edit.uid) continue;
    if (!IsSameMask(placed, line->edit))
      throw DataError(TitleOf(*line) + ": a mask cannot be given another shape or time, for its returns are dropped " +
                      "already: retire it, plumbline run, and draw it anew");
    line->edit.beams = placed.beams;
  }
}

void Tie(SiteMaps* maps, LedgerLine* line) {
  MapEdit& edit = line->edit;
  if (!edit.basis.empty() && edit.basis != maps->basis())
    throw DataError(TitleOf(*line) + ": was drawn on a map that has been made anew since; look at it again on the " +
                    "map as it is now");
  edit.basis = maps->basis();
  edit.anchors.clear();
  edit.beams.clear();
  RequireOnTheMaps(*line, *maps);
  if (edit.frame == survey::EditFrame::kMap) edit = survey::Densified(edit, kVertexSpacing_m);
  const bool masks = edit.kind == EditKind::kMaskReturns;
  const bool revised = line->operation == LedgerOperation::kModify;
  if (masks && revised) KeepBeams(maps->site(), line);
  TieToMaps(masks && !revised, maps, &edit);
  if (edit.kind == EditKind::kAdjust) RequireTails(*line);
  if (masks && edit.beams.empty())
    throw DataError(TitleOf(*line) + ": no scan has a return from there" +
                    (edit.from_ns || edit.until_ns ? " in that time" : ""));
}

// Each edit once, where the solutions of the blocks put it.
std::vector<survey::SiteEdit> PlacedBy(const std::vector<NamedFile>& solutions, const std::vector<MapEdit>& edits) {
  std::vector<survey::BlockEdits> blocks;
  for (const NamedFile& solution : solutions) {
    const bool hangs = std::any_of(edits.begin(), edits.end(),
                                   [&](const MapEdit& edit) { return edit.anchors.contains(solution.name); });
    const survey::BlockPoses poses = hangs ? ReadBlockPoses(solution.file) : survey::BlockPoses();
    blocks.push_back({.block = solution.name, .edits = survey::EditsOfBlock(solution.name, edits, poses)});
  }
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
  std::optional<SiteMaps> maps;  // retiring needs none
  for (LedgerLine& line : lines) {
    if (line.operation == LedgerOperation::kRetire) continue;
    if (!maps) maps.emplace(site);
    Tie(&*maps, &line);
  }
  return formats::AppendToLedger(LedgerFile(site), std::move(lines), expected_head);
}

}  // namespace pipeline
