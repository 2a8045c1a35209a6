// SPDX-License-Identifier: Apache-2.0
//
// Where a straight face lies, from the hits on it. The cells of a map say only that a wall runs through them, and those
// behind the face as much as those in front; the mean of the hits has no such bias, as rays err to both sides alike.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "survey/grid/hit_cells.h"

namespace survey {

// A stretch of a straight face: normal . p = offset (m), normal into the free space; `from` and `to` (m) along
// (-normal.y, normal.x), measured from the origin.
struct FaceStretch {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0.0;
  double from = 0.0;
  double to = 0.0;
};

// Offset and direction refined; the offset holds at the middle of the hits, `middle` along the face. Their standard
// deviations in m and rad.
struct FacePlace {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0.0;
  double middle = 0.0;
  double sigma_offset = 0.0;
  double sigma_angle = 0.0;
  double scatter = 0.0;  // rms distance of the hits from the face, m
};

// `about` must be right within a cell. Nothing where too little of the stretch has hits. The sigmas are those of a line
// fitted to columns of the face, a cell wide each, by the scatter of the columns about it; neighbouring columns were
// seen by the same scans and err alike, so their correlation counts.
std::optional<FacePlace> PlaceFace(std::span<const HitCell> cells, const FaceStretch& about, double cell_size_m);

}  // namespace survey
