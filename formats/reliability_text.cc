// SPDX-License-Identifier: Apache-2.0
#include "formats/reliability_text.h"

#include <cmath>

#include "formats/text_table.h"

namespace formats {
namespace {

std::string Mm(double metres) { return Number(1000.0 * metres, "%.1f"); }

std::string Mm(const std::optional<double>& metres) { return metres ? Mm(*metres) : "-"; }

void PrintVerdict(const survey::Solution& solution, std::ostream& out) {
  const survey::ControlVerdict& v = solution.control;
  out << "\ncontrol: free sigma zero " << Number(v.free_sigma_zero, "%.2f") << "; rigid fit " << Mm(v.rigid_rms)
      << " mm; scale " << Number(1e6 * v.scale_deviation, "%+.0f") << " ppm +- " << Number(1e6 * v.scale_sigma, "%.0f")
      << "; chi-square " << Number(v.chi_square, "%.1f") << " with " << v.degrees_of_freedom << " degrees, 95 % "
      << Number(v.chi_square_lower, "%.1f") << " to " << Number(v.chi_square_upper, "%.1f") << "\n";
  for (const survey::VarianceComponent& component : solution.components) {
    out << "variance of " << OneLine(component.kind) << ": factor " << Number(component.factor, "%.3f")
        << ", redundancy " << Number(component.redundancy, "%.1f") << " (" << component.count << " observations)\n";
  }
  for (const std::string& finding : solution.findings) out << "finding: " << OneLine(finding) << "\n";
}

}  // namespace

void PrintReliability(const survey::Solution& solution, std::ostream& out) {
  if (!solution.tied) return;
  PrintVerdict(solution, out);
  out << "\nreliability of the marks on control (mm; T critical " << Number(solution.control.critical_t, "%.1f")
      << ", left out beyond " << Number(solution.control.rejection_t, "%.1f") << ")\n";
  TextTable({"point", "scan", "state", "redundancy", "T", "MDB", "map shift", "LOO E", "LOO N", "sigma E", "sigma N"})
      .Print(out, [&](const auto& row) {
        for (const survey::SolvedMark& mark : solution.marks) {
          if (!mark.test) continue;
          const survey::MarkTest& test = *mark.test;
          const auto known = [&](double metres) { return test.detectable ? Mm(metres) : "-"; };
          row({OneLine(mark.point), std::to_string(mark.scan.value), mark.used ? "used" : "left out",
               Number(test.redundancy, "%.3f"), Number(test.t, "%.1f"), Mm(test.detectable), Mm(test.largest_shift),
               known(test.left_out.x()), known(test.left_out.y()), known(std::sqrt(test.left_out_covariance(0, 0))),
               known(std::sqrt(test.left_out_covariance(1, 1)))});
        }
      });
}

}  // namespace formats
