// SPDX-License-Identifier: Apache-2.0
#include "formats/reliability_html.h"

#include <cmath>

#include "formats/html.h"

namespace formats {
namespace {

using survey::BlockReliability;
using survey::MarkReliability;

constexpr const char* kNone = "&ndash;";

std::string Mm(const std::optional<double>& metres, const char* otherwise) {
  return metres ? Millimetres(*metres) : otherwise;
}

std::string Findings(const std::vector<BlockReliability>& blocks) {
  std::string items;
  for (const BlockReliability& block : blocks) {
    for (const std::string& finding : block.findings)
      items += "<li>Block " + Escaped(block.block) + ": " + Escaped(finding) + ".</li>";
  }
  return items.empty() ? "<p>No mark was left out and no test of the control failed.</p>\n"
                       : "<ul>" + items + "</ul>\n";
}

std::vector<std::string> MarkCells(const BlockReliability& block, const MarkReliability& mark) {
  const auto& residual = mark.left_out_residual;
  const auto& covariance = mark.left_out_covariance;
  const bool suspect = mark.t > block.verdict.critical_t;
  return {Escaped(block.block),
          Escaped(mark.point) + (suspect ? " <b>!</b>" : ""),
          mark.used ? "used" : "<b class=\"red\">left out</b>",
          Fixed(mark.redundancy, 3),
          Fixed(mark.t, 1),
          Mm(mark.detectable, "not controlled"),
          Mm(mark.largest_shift, kNone),
          residual ? Millimetres(residual->x()) : kNone,
          residual ? Millimetres(residual->y()) : kNone,
          covariance ? Millimetres(std::sqrt(covariance->trace())) : kNone};
}

HtmlTable BlocksTable(const std::vector<BlockReliability>& blocks) {
  HtmlTable table({"block", "&sigma;<sub>0</sub> free", "rigid RMS (mm)", "scale &minus; 1 (ppm)",
                   "&chi;&sup2; of control", "degrees", "95 % bounds", "variance components (redundancy)"},
                  1);
  for (const BlockReliability& block : blocks) {
    if (block.marks.empty()) continue;
    const survey::ControlVerdict& v = block.verdict;
    std::string components;
    for (const survey::VarianceComponent& component : block.components)
      components += (components.empty() ? "" : ", ") + Escaped(component.kind) + " " +
                    Fixed(component.factor, component.factor < 0.1 ? 3 : 2) + " (" + Fixed(component.redundancy, 0) +
                    ")";
    table.Row({Escaped(block.block), Fixed(v.free_sigma_zero, 2), Millimetres(v.rigid_rms),
               Fixed(1e6 * v.scale_deviation, 0) + " &plusmn; " + Fixed(1e6 * v.scale_sigma, 0), Fixed(v.chi_square, 1),
               std::to_string(v.degrees_of_freedom),
               Fixed(v.chi_square_lower, 1) + " &ndash; " + Fixed(v.chi_square_upper, 1), components});
  }
  return table;
}

}  // namespace

std::string ReliabilitySection(const std::vector<BlockReliability>& blocks) {
  HtmlTable marks({"block", "point", "", "redundancy", "T", "MDB", "map shift", "LOO dE", "LOO dN", "&sigma; LOO"}, 3);
  for (const BlockReliability& block : blocks) {
    for (const MarkReliability& mark : block.marks) marks.Row(MarkCells(block, mark), mark.used ? "" : "flag");
  }
  if (marks.empty()) return "";
  return "<h2>Reliability of the control</h2>\n" + Findings(blocks) + BlocksTable(blocks).Text() + marks.Text() +
         "<p class=\"note\">mm. Redundancy: share of a mark's coordinates that the others control (0: an error would "
         "not show, 1: it would show in full). T: &chi;&sup2; with 2 degrees of freedom, critical value 13.8 (0.001; "
         "!). "
         "MDB: smallest error that this test finds with a power of 80 %. Map shift: the largest shift of any pose by "
         "an "
         "error of that size. LOO: place of the mark by all others minus given coordinates, cross-validated, not "
         "tested; &sigma; of both axes. Variance components, after those of track and loops were applied: 1 where the "
         "sigmas are true. The track (scan matches and motions, which agree with each other anyway) counts by what "
         "loops and control bent it by.</p>\n";
}

}  // namespace formats
