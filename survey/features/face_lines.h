// SPDX-License-Identifier: Apache-2.0
//
// Straight wall faces in a small part of an occupancy raster: found as bands of wall cells that look the same way, then
// placed by the hits in them (face_place.h).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "survey/grid/hit_cells.h"
#include "survey/grid/site_raster.h"

namespace survey {

// A wall cell: its centre relative to the middle of the part, the direction to its free side (unit vector) and how
// much of a wall it is (0..1).
struct FaceCell {
  Eigen::Vector2d p;
  Eigen::Vector2d normal;
  double weight = 0.0;
};

// Wall cells within radius_m of a site point, which becomes their origin.
std::vector<FaceCell> FaceCellsNear(const SiteRaster& raster, const Eigen::Vector2d& p_in_site, double radius_m);

// The face is where normal . p = offset, free beyond it, from `begin` to `end` along `Along()`.
struct FaceLine {
  Eigen::Vector2d normal;  // unit, into the free space
  double offset = 0.0;
  double begin = 0.0;
  double end = 0.0;
  double middle = 0.0;        // along it: of its hits
  double sigma_offset = 0.0;  // m, at the middle
  double sigma_angle = 0.0;   // rad
  int num_cells = 0;

  Eigen::Vector2d Along() const { return {-normal.y(), normal.x()}; }
  double Length() const { return end - begin; }
  // Standard deviation of the offset at a place along the line, beyond its ends too.
  double SigmaAt(double along) const;
};

struct FaceLineOptions {
  double min_length_m = 0.2;
  int max_lines = 8;
};

// Faces in order of their weight; `hits` are those in the same part. Deterministic: the best line over all directions
// (2 degrees) and offsets (half cells) is refined by weighted total least squares, placed by its hits and its cells
// taken out, again and again. A face without hits is none.
std::vector<FaceLine> FindFaceLines(std::vector<FaceCell> cells, std::span<const HitCell> hits, double cell_size_m,
                                    const FaceLineOptions& options);

}  // namespace survey
