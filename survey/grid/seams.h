// SPDX-License-Identifier: Apache-2.0
//
// How well two block maps agree where they overlap. The blocks were placed by control alone, so whatever differs here
// is the stitching error ([CN] table 3 takes point pairs; this takes the rasters).
//
// Offsets: in square windows over the overlap the second map is shifted against the first until their walls agree best.
// A wall is a surface seen from one side: only faces whose free side looks the same way are compared, so that the two
// sides of a wall or pillar, seen from two blocks, are not taken for one displaced face.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

struct SeamOptions {
  double window_m = 8.0;               // side of the windows that give one offset each
  double search_m = 0.4;               // offsets are looked for up to this in each direction
  double wall_tolerance_m = 0.15;      // a wall of one map within this of a wall of the other is not contradicted
  double occupied_probability = 0.65;  // cells from here on are walls
  double free_probability = 0.35;      // cells up to here are clearly free
  double min_quality = 0.5;            // correlation that a window must reach
};

// One window. `offset` = place of a thing in the second map minus its place in the first (m). With one direction only
// (a straight wall) the offset is the part across it.
struct SeamPatch {
  Eigen::Vector2d centre_in_site = Eigen::Vector2d::Zero();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  Eigen::Matrix2d weight = Eigen::Matrix2d::Zero();  // curvature of the agreement; rank 1 with one direction
  int directions = 0;                                // 1 or 2
  double quality = 0.0;                              // correlation of the faces at that offset, 0..1
};

struct Seam {
  double overlap_area_m2 = 0.0;           // seen by both maps
  double disagreeing_share = 0.0;         // of the overlap: occupied in one map, free in the other
  double first_contradicted_share = 0.0;  // wall cells of the first map that the second saw as free with no wall near
  double second_contradicted_share = 0.0;
  std::vector<SeamPatch> patches;
  std::optional<Eigen::Vector2d> offset;  // all patches together; empty when they do not fix both directions
  std::optional<double> rms_m;            // root mean square offset of the patches with two directions
};

// A map with the faces of its walls (faces.h), cell by cell.
struct FacedRaster {
  SiteRaster map;
  std::vector<float> face_x;
  std::vector<float> face_y;
};

FacedRaster WithFaces(SiteRaster map, const SeamOptions& options);

// Parts of two maps give the same seam as the whole ones when they go on for so many cells round what both have seen.
std::int64_t SeamMarginCells(const SeamOptions& options, double cell_size_m);

// The rasters must have the same cell size. Without overlap the area is 0 and there are no patches.
Seam CompareMaps(const FacedRaster& first, const FacedRaster& second, const SeamOptions& options);
Seam CompareMaps(const SiteRaster& first, const SiteRaster& second, const SeamOptions& options);

}  // namespace survey
