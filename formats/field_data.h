// SPDX-License-Identifier: Apache-2.0
//
// Raw field data of any format, and what its readers have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace formats {

// How to read a raw file.
struct FieldDataOptions {
  // Topic of a bag, laser message of a CARMEN log (FLASER, RAWLASER1, ...); empty: the only one, or the front laser.
  std::string scan_topic;
  std::string imu_topic;
  std::string odometry_topic;
  // Instead of the limits that the file states (m).
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
};

// The content of one raw file, each kind in order of its stamps.
struct FieldData {
  std::vector<survey::ScanGeometry> geometries;
  std::vector<survey::Scan> scans;
  std::vector<survey::ImuSample> imu;
  std::vector<survey::OdometrySample> odometry;
  std::optional<survey::Pose2> body_from_lidar;  // where the file tells it
  std::vector<std::string> notes;                // what was left out or assumed as usual
  std::vector<std::string> warnings;             // what a person should look at
};

// Reads a raw file by its name: *.log and *.clf (CARMEN), *.bag (ROS 1), scans.csv, imu.csv, odometry.csv. DataError
// for any other, and for whatever the reader of that kind refuses.
FieldData ReadFieldData(const std::filesystem::path& file, const FieldDataOptions& options);

// Adds what another file of the same block holds. DataError when both have scans at the same time: a block has one
// scanner.
void AddFieldData(FieldData more, const std::filesystem::path& file, FieldData* data);

// The index of the geometry in the list; added when it is new.
inline int IndexOfGeometry(const survey::ScanGeometry& geometry, std::vector<survey::ScanGeometry>* geometries) {
  const auto found = std::find(geometries->begin(), geometries->end(), geometry);
  const auto index = static_cast<int>(found - geometries->begin());
  if (found == geometries->end()) geometries->push_back(geometry);
  return index;
}

// Sorts scans or samples by stamp (stable) and drops those whose stamp was there before. Returns how many were dropped.
template <typename Sample>
std::size_t SortByStamp(std::vector<Sample>* samples) {
  const auto earlier = [](const Sample& a, const Sample& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same = [](const Sample& a, const Sample& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(samples->begin(), samples->end(), earlier);
  const auto end = std::unique(samples->begin(), samples->end(), same);
  const auto dropped = static_cast<std::size_t>(samples->end() - end);
  samples->erase(end, samples->end());
  return dropped;
}

// Sorts by stamp, drops those whose stamp was there before, with a warning. DataError when more than a twentieth of the
// scans (and more than a few) go: then the clock is at fault, and a map of what is left would be none of the drive.
void SortScans(const std::string& file, FieldData* data);

template <typename Sample>
void SortSamples(const std::string& what, std::vector<Sample>* samples, FieldData* data) {
  const std::size_t dropped = SortByStamp(samples);
  if (dropped > 0)
    data->warnings.push_back(what + ": " + std::to_string(dropped) + " dropped with the stamp of the one before");
}

}  // namespace formats
