// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_joint.h"

#include "formats/html.h"

namespace formats {
namespace {

std::string BlockTable(const survey::JointSummary& joint) {
  HtmlTable table({"block", "moved, RMS (mm)", "largest (mm)", "there: east (m)", "north (m)", "sigma before (mm)",
                   "sigma now (mm)"},
                  1);
  for (const survey::JointBlock& block : joint.blocks) {
    table.Row({Escaped(block.name), Millimetres(block.rms_shift), Millimetres(block.max_shift),
               Fixed(block.place_of_max.x(), 1), Fixed(block.place_of_max.y(), 1), Millimetres(block.sigma_before),
               Millimetres(block.sigma_after)});
  }
  return table.Text();
}

std::string PairTable(const std::vector<survey::JointPair>& pairs) {
  if (pairs.empty()) return "<p>No two blocks have seen the same place.</p>\n";
  HtmlTable table({"blocks", "matches", "used", "before, RMS (mm)", "expected (mm)", "now, RMS (mm)"}, 1);
  for (const survey::JointPair& pair : pairs) {
    table.Row({Escaped(pair.block_a) + " &ndash; " + Escaped(pair.block_b), std::to_string(pair.num_matches),
               pair.contradicts ? "<b class=\"red\">contradiction</b>" : std::to_string(pair.num_used),
               Millimetres(pair.rms_before), Millimetres(pair.sigma), Millimetres(pair.rms_after)},
              pair.contradicts ? "flag" : "");
  }
  return table.Text();
}

}  // namespace

std::string JointSection(const survey::JointSummary& joint) {
  std::string text =
      "<h2>Joint adjustment of the blocks</h2>\n<p class=\"note lead\">All blocks were adjusted together: " +
      std::to_string(joint.num_control_points) + " control points, each once, " + std::to_string(joint.num_shared) +
      " of them marked in more than one block, and scans of one block matched in the map of another. Before: the "
      "block by its own control alone; reliability and blunders were tested there.</p>\n" +
      BlockTable(joint) + "<h3>Matches between blocks</h3>" + PairTable(joint.pairs);
  for (const std::string& block : joint.apart)
    text += "<p>" + Escaped(block) + " is not tied to two control points and stays as it was.</p>\n";
  return text;
}

}  // namespace formats
