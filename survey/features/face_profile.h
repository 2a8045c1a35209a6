// SPDX-License-Identifier: Apache-2.0
//
// Where in the profile of a wall its face lies, below the cell.
//
// A map by [CN] eq. (1) tells of a cell little more than its state: free, wall, or never observed. What the states mean
// is not the same on both sides of a face. On the free side rays outnumber hits, so a cell becomes wall only where a
// good part of all rays ends: where the face runs through it. Behind the face no ray passes, so the hits of the
// noisiest ranges alone make wall. A face at the front of its cells leaves one row of wall, a face at their back a
// second one behind it; to take the middle of either would be wrong by half a cell. So the place of the face is
// estimated from a model of the states: from the noise of the hits and the number of scans follow the chances of each
// state at each distance from the face, and the offset and the direction of the face are the mean of what the observed
// states leave likely. Noise and number of scans are not known and are averaged over.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

// kOpen: too little evidence, or too much against each other.
enum class CellState : std::uint8_t { kUnknown, kFree, kOpen, kWall };

struct ObservedCell {
  Eigen::Vector2d p;  // centre, m, from the origin of the part
  CellState state = CellState::kUnknown;
};

// All cells within radius_m of a site point, which becomes their origin; none where the raster ends.
std::vector<ObservedCell> CellsNear(const SiteRaster& raster, const Eigen::Vector2d& p_in_site, double radius_m);

// A stretch of a straight face: normal . p = offset (m), normal into the free space; `from` and `to` (m) along
// (-normal.y, normal.x), measured from the origin.
struct FaceStretch {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0.0;
  double from = 0.0;
  double to = 0.0;
};

// Offset and direction refined; the offset holds at the middle of the stretch. Their standard deviations in m and rad.
struct FacePlace {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0.0;
  double sigma_offset = 0.0;
  double sigma_angle = 0.0;
};

// `about` must be right within a cell and a half. Deterministic.
FacePlace PlaceFace(std::span<const ObservedCell> cells, const FaceStretch& about, double cell_size_m);

}  // namespace survey
