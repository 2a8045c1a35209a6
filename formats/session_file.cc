// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_file.h"
#include "formats/artefacts.h"

namespace formats {
namespace {

constexpr auto kSetupRow = [](auto& row, auto& id, auto& setup) {
  row(id, setup.body_from_lidar, setup.mark_in_lidar, setup.range_sigma_m, setup.mark_sigma_m);
};
constexpr auto kGeometryRow = [](auto& row, auto& id, auto& geometry) {
  row(id, geometry.angle_min_rad, geometry.angle_increment_rad, geometry.time_increment_s, geometry.range_min_m,
      geometry.range_max_m, geometry.num_beams);
};
constexpr auto kScanRow = [](auto& row, auto& id, auto& scan) {
  row(id, scan.stamp_ns, scan.geometry, scan.ranges_m, scan.clock_repair_ns);
};
constexpr auto kImuRow = [](auto& row, auto& id, auto& sample) {
  row(id, sample.stamp_ns, sample.angular_rate_in_body, sample.specific_force_in_body);
};
constexpr auto kOdometryRow = [](auto& row, auto& id, auto& sample) {
  row(id, sample.stamp_ns, sample.odom_from_body);
};
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) { row(id, mark.point, mark.start_ns, mark.end_ns); };

}  // namespace

void WriteSession(const std::filesystem::path& file, const survey::Session& session, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kSession, provenance);
  WriteOneRow(writer, "setup", session.setup, kSetupRow);
  WriteRows(writer, "geometries", session.geometries, kGeometryRow);
  WriteRows(writer, "scans", session.scans, kScanRow);
  WriteRows(writer, "imu", session.imu, kImuRow);
  WriteRows(writer, "odometry", session.odometry, kOdometryRow);
  WriteRows(writer, "marks", session.marks, kMarkRow);
  writer.Commit();
}

survey::Session ReadSession(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kSession);
  survey::Session session;
  session.setup = ReadOneRow<survey::SensorSetup>(reader, "setup", kSetupRow);
  session.geometries = ReadRows<survey::ScanGeometry>(reader, "geometries", kGeometryRow);
  session.scans = ReadRows<survey::Scan>(reader, "scans", [&](TableReader& row, auto& id, survey::Scan& scan) {
    kScanRow(row, id, scan);
    row.Require(scan.geometry >= 0 && static_cast<std::size_t>(scan.geometry) < session.geometries.size(),
                "unknown geometry");
    const int num_beams = session.geometries[static_cast<std::size_t>(scan.geometry)].num_beams;
    row.Require(scan.ranges_m.size() == static_cast<std::size_t>(num_beams),
                "the number of ranges is not that of the geometry's beams");
  });
  session.imu = ReadRows<survey::ImuSample>(reader, "imu", kImuRow);
  session.odometry = ReadRows<survey::OdometrySample>(reader, "odometry", kOdometryRow);
  session.marks = ReadRows<survey::Mark>(reader, "marks", kMarkRow);
  return session;
}

}  // namespace formats
