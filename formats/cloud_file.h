// SPDX-License-Identifier: Apache-2.0
//
// Point clouds of terrestrial scanners: PLY (ascii, binary little-endian) and PCD (ascii, binary), coordinates as float
// or double, intensities (`intensity`, `scalar_Intensity`, `reflectance`) where there are any, other properties passed
// over. The file is read piece by piece.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>

namespace formats {

struct CloudCount {
  std::int64_t num_points = 0;   // handed over
  std::int64_t num_invalid = 0;  // NaN or infinite, as organised clouds have them
};

struct CloudPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  float intensity = std::numeric_limits<float>::quiet_NaN();  // in the unit of the file; NaN: not known
};

// Calls `take` for every finite point in the order of the file. DataError names the file and the rule: not a cloud, no
// x y z, another encoding, cut off, no finite point.
CloudCount ReadCloudPoints(const std::filesystem::path& file, const std::function<void(const CloudPoint&)>& take);

// The same without intensities.
CloudCount ReadCloud(const std::filesystem::path& file, const std::function<void(const Eigen::Vector3d&)>& take);

}  // namespace formats
