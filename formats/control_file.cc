// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/errors.h"

namespace formats {
namespace {

using survey::PointRole;

constexpr std::array kRoles = {PointRole::kControl, PointRole::kCheck, PointRole::kTie, PointRole::kExcluded};

constexpr auto kFrameRow = [](auto& row, auto& id, auto& frame) { row(id, frame.crs, frame.wkt2); };
constexpr auto kPointRow = [](auto& row, auto& id, auto& point) {
  row(id, point.name, Named{point.role, kRoles}, point.position_in_site, point.covariance, point.elevation_m,
      point.elevation_sigma_m, point.description, point.reason);
};
constexpr auto kCorrelationRow = [](auto& row, auto& id, auto& pair) {
  row(id, pair.a, pair.b, pair.covariance(0, 0), pair.covariance(0, 1), pair.covariance(1, 0), pair.covariance(1, 1));
};
constexpr auto kAdjustmentRow = [](auto& row, auto& id, auto& s) {
  row(id, s.software, s.description, s.num_observations, s.num_unknowns, s.defect, s.degrees_of_freedom,
      s.sigma_zero_a_priori, s.sigma_zero, s.degrees, s.scaled, s.confidence, s.chi_square, s.chi_square_lower,
      s.chi_square_upper, s.critical_w, s.largest_w, s.num_uncontrolled, s.num_suspected);
};
constexpr auto kObservationRow = [](auto& row, auto& id, auto& o) {
  row(id, o.kind, o.from, o.to, o.fore, o.angular, o.observed, o.sigma, o.adjusted, o.residual, o.sigma_adjusted, o.w,
      o.redundancy, o.minimal_detectable_bias, o.suspected);
};
constexpr auto kRemarkRow = [](auto& row, auto& id, auto& remark) { row(id, remark); };

}  // namespace

void WriteControl(const std::filesystem::path& file, const survey::ControlNetwork& network,
                  const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kControl, provenance);
  WriteOneRow(writer, "frame", network.frame, kFrameRow);
  WriteRows(writer, "points", network.points, kPointRow);
  WriteRows(writer, "correlations", network.correlations, kCorrelationRow);
  std::vector<survey::AdjustmentSummary> summaries;
  if (network.adjustment) summaries.push_back(*network.adjustment);
  WriteRows(writer, "adjustment", summaries, kAdjustmentRow);
  WriteRows(writer, "observations", network.observations, kObservationRow);
  WriteRows(writer, "remarks", network.remarks, kRemarkRow);
  writer.Commit();
}

survey::ControlNetwork ReadControl(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kControl);
  survey::ControlNetwork network;
  network.frame = ReadOneRow<survey::SiteFrame>(reader, "frame", kFrameRow);
  network.points = ReadRows<survey::ControlPoint>(reader, "points", kPointRow);
  network.correlations = ReadRows<survey::PointCorrelation>(reader, "correlations", kCorrelationRow);
  for (const survey::PointCorrelation& pair : network.correlations) {
    if (pair.a >= 0 && pair.a < pair.b && pair.b < static_cast<int>(network.points.size())) continue;
    throw DataError(file.string() + ": table correlations: a point is not in the table points");
  }
  const auto summaries = ReadRows<survey::AdjustmentSummary>(reader, "adjustment", kAdjustmentRow);
  if (!summaries.empty()) network.adjustment = summaries.front();
  network.observations = ReadRows<survey::AdjustedObservation>(reader, "observations", kObservationRow);
  network.remarks = ReadRows<std::string>(reader, "remarks", kRemarkRow);
  return network;
}

}  // namespace formats
