// SPDX-License-Identifier: Apache-2.0
//
// Checkerboard targets in a scanner's cloud with intensities: flat boards of two black and two white squares, whose
// centre is where all four meet. Candidates are flat patches with two shades; the centre follows by least squares of
// the intensities, which are modelled as m + a tanh(x / w) tanh(y / w) in the axes of the board.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace survey {

struct BoardTarget {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // frame of the cloud, m
  double rms_share = 0.0;                            // of the intensities' residuals, against half the contrast
  int num_points = 0;
};

struct BoardSearchOptions {
  double size_m = 0.15;        // edge of the whole board
  double flatness_m = 0.006;   // rms of its points from their plane
  double max_rms_share = 0.5;  // of the model's residuals, against half the contrast
  int min_points = 60;
};

// `intensities` belong to the points, in whatever unit; NaN where not known. In order of the points' places.
// Deterministic.
std::vector<BoardTarget> FindBoards(std::span<const Eigen::Vector3f> cloud, std::span<const float> intensities,
                                    const BoardSearchOptions& options);

}  // namespace survey
