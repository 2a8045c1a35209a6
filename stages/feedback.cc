// SPDX-License-Identifier: Apache-2.0
//
// plumbline-feedback: of the site's edits those that reach back into the processing of a block, in files of their own
// that change only when they do: masks for `ingest`, arrows for `adjust`. No other edit makes these run again.
#include <algorithm>
#include <tuple>

#include "formats/digest.h"
#include "formats/edit_ledger.h"
#include "formats/feedback_files.h"
#include "pipeline/stage.h"

namespace {

using survey::MapArrow;
using survey::MapEdit;
using survey::MaskedBeams;

std::vector<MaskedBeams> MasksOf(const std::string& block, const std::vector<MapEdit>& edits) {
  std::vector<MaskedBeams> beams;
  for (const MapEdit& edit : edits) {
    const auto found = edit.beams.find(block);
    if (edit.kind != survey::EditKind::kMaskReturns || found == edit.beams.end()) continue;
    beams.insert(beams.end(), found->second.begin(), found->second.end());
  }
  std::sort(beams.begin(), beams.end(), [](const MaskedBeams& a, const MaskedBeams& b) {
    return std::tie(a.stamp_ns, a.first, a.last) < std::tie(b.stamp_ns, b.first, b.last);
  });
  return beams;
}

std::vector<MapArrow> ArrowsOf(const std::string& block, const std::vector<MapEdit>& edits) {
  std::vector<MapArrow> arrows;
  for (const MapEdit& edit : edits) {
    const auto found = edit.anchors.find(block);
    if (edit.kind != survey::EditKind::kAdjust || found == edit.anchors.end()) continue;
    for (std::size_t i = 0; i < edit.parts.size(); ++i) {
      const std::optional<survey::EditAnchor>& tail = found->second[2 * i];
      const std::string name = edit.uid + (edit.parts.size() > 1 ? "-" + std::to_string(i + 1) : "");
      if (tail) arrows.push_back({name, *tail, edit.parts[i][1], edit.sigma_m});
    }
  }
  std::sort(arrows.begin(), arrows.end(), [](const MapArrow& a, const MapArrow& b) { return a.name < b.name; });
  return arrows;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("feedback", "Tell which map edits reach back into the processing of a block: masks and arrows.",
                        "plumbline feedback --ledger edits/ledger.jsonl --block B1 --masks work/B1/masks.json --arrows "
                        "work/B1/arrows.json");
  std::filesystem::path ledger, masks, arrows;
  std::string block;
  stage.Input("ledger", &ledger, "the site's ledger of edits", pipeline::Content::kParsed);
  stage.Text("block", &block, "name of the block in the ledger");
  stage.Output("masks", &masks, "masks.json to write: returns to drop (mirror images, passers-by)");
  stage.Output("arrows", &arrows, "arrows.json to write: what the map shows here lies there");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const std::vector<MapEdit> edits = formats::ReadLedger(ledger).Active();
    const std::vector<MaskedBeams> beams = MasksOf(block, edits);
    const std::vector<MapArrow> of_block = ArrowsOf(block, edits);
    formats::WriteMasks(masks, beams, run.ProvenanceOf({{"ledger", formats::Sha256(formats::CanonicalText(beams))}}));
    formats::WriteArrows(arrows, of_block,
                         run.ProvenanceOf({{"ledger", formats::Sha256(formats::CanonicalText(of_block))}}));
    run.Message(std::to_string(beams.size()) + " runs of beams are masked, " + std::to_string(of_block.size()) +
                " arrows drawn");
  });
}
