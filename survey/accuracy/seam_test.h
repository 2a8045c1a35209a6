// SPDX-License-Identifier: Apache-2.0
//
// Whether two blocks contradict each other at their seam: the offsets between their maps against the covariance that
// their adjustments claim. The pose that drew a place stands for it: its position and heading error carried there. Both
// blocks are taken as independent, which is careful where they share control.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "survey/graph/solution.h"
#include "survey/grid/seams.h"

namespace survey {

// Covariance (m2) of what a block's map shows at a place, from the nearest pose that has one; empty without any.
std::optional<Eigen::Matrix2d> MapCovarianceAt(const Eigen::Vector2d& place, const Solution& solution);

// `ratio` = square root of d' S^-1 d / directions: lengths in units of sigma.
struct SeamVerdict {
  std::vector<double> patch_ratios;  // by patch of the seam
  std::optional<double> ratio;       // of the offset of the whole seam
  int num_beyond = 0;                // patches beyond the limit of their directions
  bool contradicts = false;          // the whole offset is beyond, or more patches than chance allows
};

// `reading_sigma_m`: of an offset read in two rasters, 1 sigma per axis. Chance of a false alarm: 0.1 % per offset.
// Without covariances in either solution there is no verdict.
std::optional<SeamVerdict> JudgeSeam(const Seam& seam, const Solution& first, const Solution& second,
                                     double reading_sigma_m);

}  // namespace survey
