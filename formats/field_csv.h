// SPDX-License-Identifier: Apache-2.0
//
// Field data as CSV: scans.csv, imu.csv, odometry.csv, marks.csv (README.md, "Field data"). One clock for all four,
// seconds; SI units. Readers throw DataError naming file, row, field, value and rule; stamps must grow from row to row.
// Writers are atomic and write the shortest text that reads back to the same value.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/field_data.h"
#include "survey/sensors/session.h"

namespace formats {

struct ScansCsv {
  survey::ScanGeometry geometry;    // num_beams from the first row
  std::vector<survey::Scan> scans;  // geometry index 0
};

// Empty field, or a range beyond range_max: kNoReturn. A range below range_min: kInvalidRange.
ScansCsv ReadScansCsv(const std::filesystem::path& file, const FieldDataOptions& options = {});
std::vector<survey::ImuSample> ReadImuCsv(const std::filesystem::path& file);
std::vector<survey::OdometrySample> ReadOdometryCsv(const std::filesystem::path& file);

// In the order of the file. `rows` gets the row of each mark, for messages.
std::vector<survey::Mark> ReadMarksCsv(const std::filesystem::path& file, std::vector<int>* rows = nullptr);

void WriteScansCsv(const std::filesystem::path& file, const survey::ScanGeometry& geometry,
                   const std::vector<survey::Scan>& scans);
void WriteImuCsv(const std::filesystem::path& file, const std::vector<survey::ImuSample>& samples);
void WriteOdometryCsv(const std::filesystem::path& file, const std::vector<survey::OdometrySample>& samples);
void WriteMarksCsv(const std::filesystem::path& file, const std::vector<survey::Mark>& marks);

}  // namespace formats
