// SPDX-License-Identifier: Apache-2.0
//
// plumbline-edit: a block's map out of its grid and the map edits that people drew.
#include <algorithm>
#include <utility>

#include "formats/block_edits_file.h"
#include "formats/digest.h"
#include "formats/edit_ledger.h"
#include "formats/raster_file.h"
#include "pipeline/descent.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/edits/apply_edits.h"

namespace {

namespace fs = std::filesystem;
using survey::AppliedEdit;

// An edit this far from a map was drawn in other coordinates.
constexpr double kTooFar_m = 10000.0;

constexpr const char* kMapEdits = "ledger";  // role of the edits that set cells

std::string TitleOf(const survey::MapEdit& edit) { return std::string(Name(edit.kind)) + " " + edit.uid; }

// Of the edits of the site those that reach the block's map.
std::vector<AppliedEdit> ReadEdits(const fs::path& ledger, const std::string& block, const fs::path& solution_file,
                                   const survey::SiteRaster& grid, bool tied) {
  std::vector<AppliedEdit> edits =
      survey::EditsOfBlock(block, formats::ReadLedger(ledger).Active(), pipeline::ReadBlockPoses(solution_file));
  for (const AppliedEdit& applied : edits) {
    const double distance_m = survey::DistanceToRaster(applied.edit, grid);
    if (tied && distance_m > kTooFar_m)
      throw formats::DataError(ledger.string() + ": " + TitleOf(applied.edit) + " lies " +
                               std::to_string(static_cast<std::int64_t>(distance_m / 1000)) +
                               " km outside the map; edits must be in site coordinates (easting, northing)");
  }
  std::erase_if(edits, [&](const AppliedEdit& applied) {
    return applied.anchored + applied.lost == 0 && survey::DistanceToRaster(applied.edit, grid) > 0;
  });
  return edits;
}

// Input of what is made from these edits alone.
formats::ProvenanceInput InputOf(const std::string& role, const std::string& block,
                                 const std::vector<AppliedEdit>& edits, bool (*counts)(const survey::MapEdit&)) {
  std::vector<survey::MapEdit> counted;
  for (const AppliedEdit& applied : edits) {
    if (counts(applied.edit)) counted.push_back(applied.edit);
  }
  return {role, counted.empty() ? "" : formats::Sha256(formats::CanonicalText(block, counted))};
}

bool SetsCells(const survey::MapEdit& edit) { return StateOf(edit).has_value(); }
bool IsAny(const survey::MapEdit&) { return true; }

// The map's record with other edits in the ledger's place, so that a file changes with its own edits alone.
formats::Provenance WithEdits(formats::Provenance provenance, const formats::ProvenanceInput& edits) {
  std::vector<formats::ProvenanceInput>& inputs = provenance.records.front().inputs;
  std::erase_if(inputs, [](const auto& input) { return input.role == kMapEdits; });
  if (edits.sha256.empty()) return provenance;
  const auto place =
      std::find_if(inputs.begin(), inputs.end(), [&](const auto& input) { return input.role > edits.role; });
  inputs.insert(place, edits);
  return provenance;
}

void Tell(const survey::BlockEdits& edits, bool allow_conflicts, const fs::path& ledger, pipeline::StageRun& run) {
  std::string conflicts;
  for (const survey::EditFinding& finding : edits.findings) {
    const bool refused = finding.kind == survey::FindingKind::kConflict && !allow_conflicts;
    if (!refused) run.Warn(std::string(Name(finding.kind)) + ": " + finding.message);
    if (refused) conflicts += "\n  " + finding.message;
  }
  if (!conflicts.empty())
    throw formats::DataError(ledger.string() +
                             ": people contradict each other: retire one of the edits, let the later " +
                             "one supersede the other, or set allow-conflicts:" + conflicts);
  for (const AppliedEdit& applied : edits.edits)
    run.Message(TitleOf(applied.edit) + ": " + std::to_string(applied.changed_cells) + " cells");
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("edit", "Apply people's map edits to the grid of a block.",
                        "plumbline edit --grid work/B1/grid.tif --solution work/B1/solution.sqlite --block B1 "
                        "--ledger edits/ledger.jsonl --output work/B1/map.tif --report work/B1/edits.json "
                        "--doubtful work/B1/doubtful_edits.json");
  fs::path grid_file, solution_file, ledger, output, report, doubtful_file;
  std::string block;
  bool allow_conflicts = false;
  survey::RefitLimits limits;
  stage.Input("grid", &grid_file, "grid of the block");
  stage.Input("solution", &solution_file, "the solution that the grid was made from");
  stage.OptionalInput("ledger", &ledger, "the site's ledger of edits", pipeline::Content::kParsed);
  stage.Text("block", &block, "name of the block in the ledger");
  stage.Output("output", &output, "map.tif to write");
  stage.Output("report", &report, "edits.json to write: what each edit did, and what a person should look at");
  stage.Output("doubtful", &doubtful_file,
               "doubtful_edits.json to write: of these the edits that `requests` asks about");
  stage.Option("allow-conflicts", &allow_conflicts,
               "true: where people contradict each other the later edit counts, and the certificate names both");
  stage.Option("refit-residual-m", &limits.residual_m,
               "an edit under which the map was bent by more is to be looked at (m)", {.min = 0.0});
  stage.Option("refit-area-change", &limits.area_change, "... or whose area changed by more (share)", {.min = 0.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::RasterLabel label;
    const survey::RasterStrips grid = formats::OpenRaster(grid_file, &label);
    pipeline::RequireDescent(grid_file, solution_file);
    std::vector<AppliedEdit> concerned;
    if (!ledger.empty() && block.empty()) throw formats::UsageError("--ledger needs --block, the block's name in it");
    if (!ledger.empty()) concerned = ReadEdits(ledger, block, solution_file, grid.frame, label.tied);
    if (!concerned.empty() && !label.tied)
      run.Warn("the block is not tied to control: the edits are taken in its local frame");
    const formats::ProvenanceInput of_map = InputOf(kMapEdits, block, concerned, SetsCells);
    const formats::ProvenanceInput of_report = InputOf("ledger, all kinds", block, concerned, IsAny);
    if (!of_map.sha256.empty()) run.AddInput(of_map);
    survey::SiteRaster part = survey::PartUnder(concerned, grid);
    const survey::BlockEdits edits = survey::ApplyEdits(block, std::move(concerned), limits, &part);
    Tell(edits, allow_conflicts, ledger, run);
    formats::WriteRaster(output, survey::WithPart(grid, std::move(part)), label, run.Provenance());
    formats::WriteBlockEdits(report, edits, WithEdits(run.Provenance(), of_report));
    const survey::BlockEdits doubtful = survey::Doubtful(edits);
    formats::WriteBlockEdits(
        doubtful_file, doubtful,
        WithEdits(run.Provenance(), InputOf("ledger, doubtful edits", block, doubtful.edits, IsAny)));
    if (edits.edits.empty()) run.Message("no edits: the map is the grid");
  });
}
