// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/check_analysis.h"

#include <map>
#include <utility>

#include "survey/accuracy/moments.h"
#include "survey/accuracy/outliers.h"

namespace survey {
namespace {

// The mean error of each point, or of each point in each block.
struct MeanErrors {
  std::vector<Eigen::Vector2d> errors;
  std::vector<Eigen::Vector2d> positions;
  std::vector<int> blocks;
};

MeanErrors Means(std::span<const PlacedError> errors, bool by_block) {
  std::map<std::pair<int, int>, std::vector<Eigen::Vector2d>> members;
  std::map<std::pair<int, int>, Eigen::Vector2d> positions;
  for (const PlacedError& each : errors) {
    const std::pair<int, int> key(each.point, by_block ? each.block : 0);
    members[key].push_back(each.error);
    positions[key] = each.position;
  }
  MeanErrors means;
  for (const auto& [key, values] : members) {
    means.errors.push_back(MeanOf(values));
    means.positions.push_back(positions[key]);
    means.blocks.push_back(key.second);
  }
  return means;
}

}  // namespace

CheckAnalysis AnalyseErrors(std::span<const PlacedError> errors, std::vector<int>* outliers) {
  std::vector<Eigen::Vector2d> all;
  for (const PlacedError& each : errors) all.push_back(each.error);
  *outliers = FindErrorOutliers(all);
  const MeanErrors of_points = Means(errors, false), of_blocks = Means(errors, true);
  return {.normality = TestNormality(of_points.errors),
          .num_outliers = static_cast<int>(outliers->size()),
          .block_effect = TestBlockEffect(of_blocks.errors, of_blocks.blocks),
          .moran = TestMoran(of_points.positions, of_points.errors)};
}

}  // namespace survey
