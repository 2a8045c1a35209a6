// SPDX-License-Identifier: Apache-2.0
//
// plumbline-masks: of the site's edits those that reach back to the field data of one block, in a file of their own
// that changes only when they do: no other edit makes the front end run again.
#include <algorithm>
#include <tuple>

#include "formats/digest.h"
#include "formats/edit_ledger.h"
#include "formats/masks_file.h"
#include "pipeline/stage.h"

namespace {

std::vector<survey::MaskedBeams> MasksOf(const std::string& block, const std::vector<survey::MapEdit>& edits) {
  std::vector<survey::MaskedBeams> beams;
  for (const survey::MapEdit& edit : edits) {
    const auto found = edit.beams.find(block);
    if (edit.kind != survey::EditKind::kMaskReturns || found == edit.beams.end()) continue;
    beams.insert(beams.end(), found->second.begin(), found->second.end());
  }
  std::sort(beams.begin(), beams.end(), [](const survey::MaskedBeams& a, const survey::MaskedBeams& b) {
    return std::tie(a.stamp_ns, a.first, a.last) < std::tie(b.stamp_ns, b.first, b.last);
  });
  return beams;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("masks", "Tell which returns of a block people masked (mirror images, passers-by).",
                        "plumbline masks --ledger edits/ledger.jsonl --block B1 --output work/B1/masks.json");
  std::filesystem::path ledger, output;
  std::string block;
  stage.Input("ledger", &ledger, "the site's ledger of edits", pipeline::Content::kParsed);
  stage.Text("block", &block, "name of the block in the ledger");
  stage.Output("output", &output, "masks.json to write");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const std::vector<survey::MaskedBeams> beams = MasksOf(block, formats::ReadLedger(ledger).Active());
    run.AddInput({"ledger", formats::Sha256(formats::CanonicalText(beams))});
    formats::WriteMasks(output, beams, run.Provenance());
    run.Message(std::to_string(beams.size()) + " runs of beams are masked");
  });
}
