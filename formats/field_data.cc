// SPDX-License-Identifier: Apache-2.0
#include "formats/field_data.h"

#include <iterator>

#include "formats/carmen_log.h"
#include "formats/errors.h"
#include "formats/field_csv.h"
#include "formats/ros_bag.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

std::string LowerCase(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

FieldData ReadScans(const fs::path& file, const FieldDataOptions& options) {
  ScansCsv csv = ReadScansCsv(file, options);
  FieldData data;
  data.geometries.push_back(csv.geometry);
  data.scans = std::move(csv.scans);
  return data;
}

template <typename Sample>
void Append(std::vector<Sample> more, std::vector<Sample>* samples) {
  samples->insert(samples->end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

template <typename Sample>
void AppendSamples(const std::string& kind, std::vector<Sample> more, FieldData* data, std::vector<Sample>* samples) {
  if (more.empty()) return;
  Append(std::move(more), samples);
  const std::size_t dropped = SortByStamp(samples);
  if (dropped > 0) data->notes.push_back(kind + ": " + std::to_string(dropped) + " that two files hold are taken once");
}

}  // namespace

void SortScans(const std::string& file, FieldData* data) {
  constexpr std::size_t kFew = 20;
  const std::size_t count = data->scans.size();
  SortSamples("scans", &data->scans, data);
  const std::size_t dropped = count - data->scans.size();
  if (dropped <= kFew || dropped <= count / 20) return;
  throw DataError(file + ": " + std::to_string(dropped) + " of " + std::to_string(count) +
                  " scans have the time stamp of another: the clock of the log stands still or is too coarse");
}

FieldData ReadFieldData(const fs::path& file, const FieldDataOptions& options) {
  const std::string name = LowerCase(file.filename().string());
  const std::string extension = LowerCase(file.extension().string());
  if (extension == ".log" || extension == ".clf") return ReadCarmenLog(file, options);
  if (extension == ".bag") return ReadRosBag(file, options);
  if (name == "scans.csv") return ReadScans(file, options);
  if (name == "imu.csv") return {.imu = ReadImuCsv(file)};
  if (name == "odometry.csv") return {.odometry = ReadOdometryCsv(file)};
  std::string hint;
  if (name == "marks.csv") hint = "; marks are given by --marks";
  if (extension == ".bz2" || extension == ".gz") hint = "; unpack it first";
  throw DataError(
      file.string() +
      ": is not the name of raw data: *.log, *.clf (CARMEN), *.bag (ROS 1), scans.csv, imu.csv, odometry.csv" + hint);
}

void AddFieldData(FieldData more, const fs::path& file, FieldData* data) {
  if (!more.scans.empty() && !data->scans.empty() && more.scans.front().stamp_ns <= data->scans.back().stamp_ns &&
      more.scans.back().stamp_ns >= data->scans.front().stamp_ns) {
    throw DataError(file.string() + ": its scans from " + StampText(more.scans.front().stamp_ns) + " to " +
                    StampText(more.scans.back().stamp_ns) +
                    " overlap in time with those of another file; a block has one scanner");
  }
  for (survey::Scan& scan : more.scans) {
    const survey::ScanGeometry& geometry = more.geometries[static_cast<std::size_t>(scan.geometry)];
    scan.geometry = IndexOfGeometry(geometry, &data->geometries);
  }
  AppendSamples("scans", std::move(more.scans), data, &data->scans);
  AppendSamples("IMU samples", std::move(more.imu), data, &data->imu);
  AppendSamples("odometry samples", std::move(more.odometry), data, &data->odometry);
  if (!data->body_from_lidar) data->body_from_lidar = more.body_from_lidar;
  Append(std::move(more.notes), &data->notes);
  Append(std::move(more.warnings), &data->warnings);
}

}  // namespace formats
