// SPDX-License-Identifier: Apache-2.0
//
// A plane reference from a cloud: the points of a band of heights, thinned to the mean of each small cell.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace survey {

struct SliceOptions {
  double from_elevation_m = 0.0;
  double to_elevation_m = 0.0;
  double cell_m = 0.005;
};

// Takes points one by one, so that a cloud need not be held in memory.
class CloudSlice {
 public:
  explicit CloudSlice(const SliceOptions& options) : options_(options) {}

  void Add(const Eigen::Vector3d& p_in_site);

  // In order of cells, west to east, then south to north.
  std::vector<Eigen::Vector2d> Points() const;

 private:
  struct Sum {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    std::int64_t count = 0;
  };

  SliceOptions options_;
  std::map<std::pair<std::int64_t, std::int64_t>, Sum> cells_;
};

}  // namespace survey
