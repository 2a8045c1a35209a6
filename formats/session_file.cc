// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <memory>
#include <mutex>

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
constexpr auto kImuRow = [](auto& row, auto& id, auto& sample) {
  row(id, sample.stamp_ns, sample.angular_rate_in_body, sample.specific_force_in_body);
};
constexpr auto kOdometryRow = [](auto& row, auto& id, auto& sample) {
  row(id, sample.stamp_ns, sample.odom_from_body);
};
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) { row(id, mark.point, mark.start_ns, mark.end_ns); };

// The ranges in a session that was read and found whole.
class StoredRanges : public survey::ScanRanges {
 public:
  explicit StoredRanges(const std::filesystem::path& file)
      : database_(Database::OpenForReading(file)),
        select_(database_.Prepare("SELECT ranges FROM scans WHERE id = ?")) {}

  void Read(std::size_t scan, std::vector<float>* ranges_m) const override {
    const std::lock_guard lock(mutex_);
    select_.Bind(1, static_cast<std::int64_t>(scan));
    select_.Step();
    const std::span<const std::byte> bytes = select_.Blob(0);
    ranges_m->resize(bytes.size() / sizeof(float));
    std::memcpy(ranges_m->data(), bytes.data(), bytes.size());
    select_.Reset();
  }

 private:
  mutable std::mutex mutex_;
  Database database_;
  mutable Statement select_;
};

}  // namespace

void WriteSession(const std::filesystem::path& file, const survey::Session& session, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kSession, provenance);
  WriteOneRow(writer, "setup", session.setup, kSetupRow);
  WriteRows(writer, "geometries", session.geometries, kGeometryRow);
  writer.Table("scans", [&](TableWriter& row) {
    std::vector<float> buffer;
    for (std::size_t i = 0; i < session.scans.size(); ++i) {
      const survey::Scan& scan = session.scans[i];
      row(i, scan.stamp_ns, scan.geometry, survey::RangesOf(session, i, &buffer), scan.clock_repair_ns);
    }
  });
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
  // Each row is checked as a whole; its ranges are read again when they are asked for.
  session.scans = ReadRows<survey::Scan>(reader, "scans", [&](TableReader& row, auto& id, survey::Scan& scan) {
    row(id, scan.stamp_ns, scan.geometry, scan.ranges_m, scan.clock_repair_ns);
    row.Require(scan.geometry >= 0 && static_cast<std::size_t>(scan.geometry) < session.geometries.size(),
                "unknown geometry");
    const int num_beams = session.geometries[static_cast<std::size_t>(scan.geometry)].num_beams;
    row.Require(scan.ranges_m.size() == static_cast<std::size_t>(num_beams),
                "the number of ranges is not that of the geometry's beams");
    scan.ranges_m = std::vector<float>();
  });
  session.ranges = std::make_shared<StoredRanges>(file);
  session.imu = ReadRows<survey::ImuSample>(reader, "imu", kImuRow);
  session.odometry = ReadRows<survey::OdometrySample>(reader, "odometry", kOdometryRow);
  session.marks = ReadRows<survey::Mark>(reader, "marks", kMarkRow);
  return session;
}

}  // namespace formats
