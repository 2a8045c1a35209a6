// SPDX-License-Identifier: Apache-2.0
//
// How an edit that was drawn on a map follows it. Each vertex hangs on the scan that drew the cell under it
// (SiteRaster::drawn_by), so that it moves with its wall when a new solution moves the scans. Anchors name scans by
// their stamps: they hold although the block is tracked anew.
#pragma once

#include <optional>
#include <vector>

#include "survey/edits/block_edits.h"
#include "survey/edits/map_edit.h"
#include "survey/geometry/pose2.h"
#include "survey/grid/site_raster.h"
#include "survey/sensors/session.h"

namespace survey {

// The scans of a block in one solution, in order of their stamps.
struct BlockPoses {
  std::vector<StampNs> stamps;
  std::vector<Pose2> site_from_scan;
};

// Vertices put in so that no segment of a line or ring is longer than spacing_m; arrows and squares stay as they are.
MapEdit Densified(const MapEdit& edit, double spacing_m);

// The part of a map that AnchorsOf looks at; which scans drew its cells is left open.
SiteRaster PartAround(const MapEdit& edit, const SiteRaster& map);

// For each vertex the scan that drew the nearest cell of `grid` within 0.5 m (squares: all four corners by the cell in
// their middle), empty where there is none and for the heads of arrows. `grid`, with drawn_by, was drawn at `poses`.
std::vector<std::optional<EditAnchor>> AnchorsOf(const MapEdit& edit, const SiteRaster& grid, const BlockPoses& poses);

// The edit with its vertices where `poses` put their anchors; vertices without one move with the others of the edit,
// the nearer the more. An edit without anchors, or whose scans are all gone, stays. Heads of arrows stay.
AppliedEdit MovedWithScans(const MapEdit& edit, const std::vector<std::optional<EditAnchor>>& anchors,
                           const BlockPoses& poses);

}  // namespace survey
