// SPDX-License-Identifier: Apache-2.0
//
// Point clouds of terrestrial scanners: PLY (ascii, binary little-endian) and PCD (ascii, binary), coordinates as float
// or double, other properties passed over. The file is read piece by piece.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace formats {

struct CloudCount {
  std::int64_t num_points = 0;   // handed over
  std::int64_t num_invalid = 0;  // NaN or infinite, as organised clouds have them
};

// Calls `take` for every finite point in the order of the file. DataError names the file and the rule: not a cloud, no
// x y z, another encoding, cut off, no finite point.
CloudCount ReadCloud(const std::filesystem::path& file, const std::function<void(const Eigen::Vector3d&)>& take);

}  // namespace formats
