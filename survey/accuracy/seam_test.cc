// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/seam_test.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "survey/graph/map_uncertainty.h"

namespace survey {
namespace {

// Square roots of chi-square's 99.9 % points over the degrees of freedom: 10.828 with one, 13.816 with two.
constexpr double kLimit[3] = {0.0, 3.2905, 2.6283};
constexpr double kPatchesBeyond = 0.2;  // of all patches: more is not clutter
constexpr std::size_t kFewestForScatter = 4;

// Length of an offset in sigmas; with one direction along that direction.
double Ratio(const Eigen::Vector2d& offset, int directions, const Eigen::Matrix2d& covariance) {
  if (directions == 2) return std::sqrt(offset.dot(covariance.inverse() * offset) / 2.0);
  const double length = offset.norm();
  if (length == 0.0) return 0.0;
  const Eigen::Vector2d across = offset / length;
  return length / std::sqrt(across.dot(covariance * across));
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Scatter of the patches that are known in both directions, per axis: 1.4826 times the median deviation from the
// median.
double Scatter(const Seam& seam) {
  std::vector<double> values[2];
  for (const SeamPatch& patch : seam.patches) {
    if (patch.directions != 2) continue;
    for (const int axis : {0, 1}) values[axis].push_back(patch.offset(axis));
  }
  if (values[0].size() < kFewestForScatter) return 0.0;
  std::vector<double> deviations;
  for (const int axis : {0, 1}) {
    const double median = Median(values[axis]);
    for (const double value : values[axis]) deviations.push_back(std::abs(value - median));
  }
  return 1.4826 * Median(deviations);
}

}  // namespace

std::optional<SeamVerdict> JudgeSeam(const Seam& seam, const Solution& first, const Solution& second,
                                     double reading_sigma_m) {
  const double scatter = Scatter(seam);
  const Eigen::Matrix2d reading = Eigen::Matrix2d::Identity() * reading_sigma_m * reading_sigma_m;
  const Eigen::Matrix2d clutter = Eigen::Matrix2d::Identity() * scatter * scatter;
  SeamVerdict verdict;
  Eigen::Matrix2d mean = Eigen::Matrix2d::Zero();
  for (const SeamPatch& patch : seam.patches) {
    const std::optional<Eigen::Matrix2d> of_first = MapCovarianceAt(patch.centre_in_site, first);
    const std::optional<Eigen::Matrix2d> of_second = MapCovarianceAt(patch.centre_in_site, second);
    if (!of_first || !of_second) return std::nullopt;
    const Eigen::Matrix2d covariance = *of_first + *of_second + reading;
    mean += covariance / static_cast<double>(seam.patches.size());
    verdict.patch_ratios.push_back(Ratio(patch.offset, patch.directions, covariance + clutter));
    if (verdict.patch_ratios.back() > kLimit[patch.directions]) ++verdict.num_beyond;
  }
  if (seam.offset && !seam.patches.empty()) verdict.ratio = Ratio(*seam.offset, 2, mean);
  const double allowed = std::max(1.0, kPatchesBeyond * static_cast<double>(seam.patches.size()));
  verdict.contradicts = verdict.ratio.value_or(0.0) > kLimit[2] || verdict.num_beyond > allowed;
  return verdict;
}

}  // namespace survey
