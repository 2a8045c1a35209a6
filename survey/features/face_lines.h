// SPDX-License-Identifier: Apache-2.0
//
// Straight wall faces in a small part of an occupancy raster, with the place of the face below the cell.
//
// A wall in a raster is the band of cells in which its face was hit, more than the noise is wide. The band is not
// centred on the face. On the free side most rays pass a cell, so it counts as wall only where hits are more than a
// few percent of them (about one sigma in front of the face); behind the face no ray passes and a single hit is enough
// (about three sigmas). So of the growth of the band beyond the cells that the face itself crosses a quarter lies in
// front and three quarters behind, and the face lies a quarter of the growth in front of the band's middle.
#pragma once

#include <Eigen/Core>
#include <vector>

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
  double sigma_offset = 0.0;  // m, at the middle of the line
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

// Faces in order of their weight. Deterministic: the best line over all directions (2 degrees) and offsets (half cells)
// is refined by weighted total least squares and its cells taken out, again and again.
std::vector<FaceLine> FindFaceLines(std::vector<FaceCell> cells, double cell_size_m, const FaceLineOptions& options);

}  // namespace survey
