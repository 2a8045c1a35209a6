// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"

namespace formats {
namespace {

using survey::PointRole;

constexpr std::array kRoles = {PointRole::kControl, PointRole::kCheck, PointRole::kTie, PointRole::kExcluded};

constexpr auto kFrameRow = [](auto& row, auto& id, auto& frame) { row(id, frame.crs, frame.wkt2); };
constexpr auto kPointRow = [](auto& row, auto& id, auto& point) {
  row(id, point.name, Named{point.role, kRoles}, point.position_in_site, point.covariance, point.elevation_m,
      point.description, point.reason);
};

}  // namespace

void WriteControl(const std::filesystem::path& file, const survey::ControlNetwork& network,
                  const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kControl, provenance);
  WriteOneRow(writer, "frame", network.frame, kFrameRow);
  WriteRows(writer, "points", network.points, kPointRow);
  writer.Commit();
}

survey::ControlNetwork ReadControl(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kControl);
  survey::ControlNetwork network;
  network.frame = ReadOneRow<survey::SiteFrame>(reader, "frame", kFrameRow);
  network.points = ReadRows<survey::ControlPoint>(reader, "points", kPointRow);
  return network;
}

}  // namespace formats
