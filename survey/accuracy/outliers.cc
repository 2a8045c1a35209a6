// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/outliers.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "survey/accuracy/distributions.h"
#include "survey/accuracy/moments.h"

namespace survey {
namespace {

constexpr std::size_t kFewest = 10;

struct Farthest {
  std::size_t place = 0;   // among the errors that remain
  double statistic = 0.0;  // D^2 m / (m-1)^2 with the sample covariance: beta (1, (m-3)/2) for a given error
};

std::optional<Farthest> FindFarthest(std::span<const Eigen::Vector2d> errors) {
  const std::optional<Eigen::Matrix2d> information = InverseOfSpread(SecondMomentAboutMean(errors));
  if (!information) return std::nullopt;
  const Eigen::Vector2d mean = MeanOf(errors);
  Farthest farthest;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Eigen::Vector2d deviation = errors[i] - mean;
    const double squared = deviation.dot(*information * deviation) / static_cast<double>(errors.size() - 1);
    if (squared > farthest.statistic) farthest = {i, squared};
  }
  return farthest;
}

}  // namespace

std::vector<int> FindErrorOutliers(std::span<const Eigen::Vector2d> errors, double significance) {
  if (errors.size() < kFewest) return {};
  std::vector<Eigen::Vector2d> rest(errors.begin(), errors.end());
  std::vector<int> indices(errors.size());
  std::iota(indices.begin(), indices.end(), 0);
  std::vector<int> removed;
  std::size_t num_outliers = 0;
  for (std::size_t step = 0; step < errors.size() / 10 + 1; ++step) {
    const std::optional<Farthest> farthest = FindFarthest(rest);
    if (!farthest) break;
    const auto m = static_cast<double>(rest.size());
    const double critical = BetaQuantile(1.0 - significance / m, 1.0, 0.5 * (m - 3.0));
    const auto place = static_cast<std::ptrdiff_t>(farthest->place);
    removed.push_back(indices[farthest->place]);
    if (farthest->statistic > critical) num_outliers = removed.size();
    rest.erase(rest.begin() + place);
    indices.erase(indices.begin() + place);
  }
  removed.resize(num_outliers);
  return removed;
}

}  // namespace survey
