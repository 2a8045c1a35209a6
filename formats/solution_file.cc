// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/errors.h"
#include "formats/navigation_table.h"
#include "formats/scans_table.h"

namespace formats {
namespace {

constexpr auto kBlockRow = [](auto& row, auto& id, auto& solution) {
  row(id, solution.tied, solution.frame.crs, solution.frame.wkt2, solution.site_from_local, solution.rigid_scale);
};
constexpr auto kScanRow = [](auto& row, auto& stamp, auto& scan) {
  row(scan.scan, stamp, scan.site_from_scan, scan.is_node);
};
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) {
  row(id, mark.point, mark.start_ns, mark.end_ns, mark.scan, mark.used, mark.position_in_site, mark.covariance,
      mark.residual, mark.rigid_residual, mark.left_out);
};
constexpr auto kTestRow = [](auto& row, auto& mark, auto& test) {
  row(mark, test.redundancy, test.t, test.degrees_of_freedom, test.detectable, test.largest_shift, test.left_out,
      test.left_out_covariance);
};
constexpr auto kVerdictRow = [](auto& row, auto& id, auto& verdict) {
  row(id, verdict.free_sigma_zero, verdict.rigid_rms, verdict.scale_deviation, verdict.scale_sigma, verdict.chi_square,
      verdict.degrees_of_freedom, verdict.chi_square_lower, verdict.chi_square_upper, verdict.critical_t,
      verdict.rejection_t, verdict.contradicted);
};
constexpr auto kComponentRow = [](auto& row, auto& id, auto& component) {
  row(id, component.kind, component.count, component.redundancy, component.factor);
};
constexpr auto kFindingRow = [](auto& row, auto& id, auto& finding) { row(id, finding); };
constexpr auto kBreakRow = [](auto& row, auto& id, auto& gap) { row(id, gap.scan, gap.message); };
constexpr auto kStatisticsRow = [](auto& row, auto& id, auto& statistics) {
  row(id, statistics.num_nodes, statistics.num_submaps, statistics.num_track_constraints, statistics.num_loops,
      statistics.num_control_marks, statistics.degrees_of_freedom, statistics.iterations, statistics.initial_cost,
      statistics.final_cost, statistics.sigma_zero);
};

}  // namespace

void WriteSolution(const std::filesystem::path& file, const survey::Solution& solution,
                   const std::vector<survey::ScanStamp>& scan_stamps, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kSolution, provenance);
  WriteOneRow(writer, "block", solution, kBlockRow);
  WriteScans(writer, solution.scans, scan_stamps, kScanRow);
  writer.Table("node_covariances", [&](TableWriter& row) {
    for (const survey::NodeCovariance& node : solution.covariances) row(node.scan, node.covariance);
  });
  writer.Table("submaps", [&](TableWriter& row) {
    for (const survey::SolvedSubmap& submap : solution.submaps) row(submap.id, submap.site_from_submap);
  });
  WriteRows(writer, "marks", solution.marks, kMarkRow);
  writer.Table("mark_tests", [&](TableWriter& row) {
    for (std::size_t i = 0; i < solution.marks.size(); ++i) {
      const int mark = static_cast<int>(i);
      if (solution.marks[i].test) kTestRow(row, mark, *solution.marks[i].test);
    }
  });
  WriteOneRow(writer, "control_verdict", solution.control, kVerdictRow);
  WriteRows(writer, "variance_components", solution.components, kComponentRow);
  WriteRows(writer, "findings", solution.findings, kFindingRow);
  WriteOneRow(writer, "navigation", solution.navigation, kNavigationRow);
  WriteRows(writer, "breaks", solution.breaks, kBreakRow);
  WriteOneRow(writer, "statistics", solution.statistics, kStatisticsRow);
  writer.Commit();
}

survey::Solution ReadSolution(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kSolution);
  auto solution = ReadOneRow<survey::Solution>(reader, "block", kBlockRow);
  solution.scans = ReadScans<survey::SolvedScan>(reader, kScanRow);
  reader.Table("node_covariances", [&](TableReader& row) {
    survey::NodeCovariance& node = solution.covariances.emplace_back();
    row(node.scan, node.covariance);
  });
  reader.Table("submaps", [&](TableReader& row) {
    survey::SolvedSubmap& submap = solution.submaps.emplace_back();
    row(submap.id, submap.site_from_submap);
  });
  solution.marks = ReadRows<survey::SolvedMark>(reader, "marks", kMarkRow);
  reader.Table("mark_tests", [&](TableReader& row) {
    int mark = 0;
    survey::MarkTest test;
    kTestRow(row, mark, test);
    row.Require(mark >= 0 && static_cast<std::size_t>(mark) < solution.marks.size(), "there is no such mark");
    solution.marks[static_cast<std::size_t>(mark)].test = test;
  });
  solution.control = ReadOneRow<survey::ControlVerdict>(reader, "control_verdict", kVerdictRow);
  solution.components = ReadRows<survey::VarianceComponent>(reader, "variance_components", kComponentRow);
  solution.findings = ReadRows<std::string>(reader, "findings", kFindingRow);
  solution.navigation = ReadOneRow<survey::NavigationSummary>(reader, "navigation", kNavigationRow);
  solution.breaks = ReadRows<survey::TrackBreak>(reader, "breaks", kBreakRow);
  solution.statistics = ReadOneRow<survey::AdjustmentStatistics>(reader, "statistics", kStatisticsRow);
  return solution;
}

std::vector<survey::ScanStamp> ReadScanStamps(const std::filesystem::path& file) {
  const ArtefactKind kind = KindOfArtefact(file);
  if (kind != ArtefactKind::kTrack && kind != ArtefactKind::kSolution)
    throw DataError(file.string() + ": a " + std::string(FormatOf(kind).name) + " file, expected a track or solution");
  ArtefactReader reader(file, kind);
  std::vector<survey::ScanStamp> stamps;
  reader.Table("scans", [&](TableReader& row) {
    survey::ScanId scan;
    row(scan, stamps.emplace_back());
  });
  return stamps;
}

}  // namespace formats
