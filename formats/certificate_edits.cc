// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_edits.h"

#include "formats/html.h"

namespace formats {
namespace {

std::string Counted(int count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string Findings(const std::vector<std::string>& findings) {
  if (findings.empty()) return P("No edit contradicts another one, newer scans or the map under it.");
  std::string list = "<h3>To be looked at</h3><ul>";
  for (const std::string& finding : findings) list += "<li>" + Escaped(finding) + "</li>";
  return list + "</ul>\n";
}

}  // namespace

std::string EditsSection(const survey::EditSummary& edits) {
  HtmlTable table({"block", "edits", "cells that people set", "farthest moved (mm)"}, 1);
  for (const survey::EditedBlock& block : edits.blocks) {
    table.Row({Escaped(block.block), std::to_string(block.num_edits), std::to_string(block.edited_cells),
               Millimetres(block.max_shift_m)});
  }
  return H2("Map edits") +
         P("People set cells by " + Counted(edits.num_edits, "edit", "edits") + ", forbade " +
           Counted(edits.num_forbidden, "area", "areas") + " to robots and masked the returns of " +
           Counted(edits.num_masks, "area", "areas") +
           ". Check features are measured in the map as scanned: no edit takes part in a test of accuracy. An edit "
           "that was drawn on the map moves with the scans under it when the block is adjusted anew.") +
         (table.empty() ? "" : table.Text()) + Findings(edits.findings);
}

}  // namespace formats
