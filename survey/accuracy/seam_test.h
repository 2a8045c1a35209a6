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

// `ratio` = square root of d' S^-1 d / directions: lengths in units of sigma.
struct SeamVerdict {
  std::vector<double> patch_ratios;  // by patch of the seam
  std::optional<double> ratio;       // of the offset of the whole seam
  int num_beyond = 0;                // patches beyond the limit of their directions
  bool contradicts = false;          // the whole offset is beyond, or more than a fifth of the patches, two at least
};

// Limits: 99.9 % of chi-square. `reading_sigma_m`: of an offset read in two rasters, 1 sigma per axis; it does not
// average out over a seam, for a wall is drawn some way to the side that it was seen from. What single patches scatter
// beyond it (parked cars, people) is taken from the seam itself, robustly. Without covariances in either solution there
// is no verdict.
std::optional<SeamVerdict> JudgeSeam(const Seam& seam, const Solution& first, const Solution& second,
                                     double reading_sigma_m);

}  // namespace survey
