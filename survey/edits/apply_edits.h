// SPDX-License-Identifier: Apache-2.0
//
// The rules by which the edits of a site come into the map of a block: free and unknown first, then occupied, then what
// leaves the occupancy alone; among these by time and uid, so that the order of files and lines does not count. Nothing
// that contradicts is settled silently: people who disagree and scans that are newer than an edit become findings.
#pragma once

#include <string>
#include <vector>

#include "survey/edits/anchoring.h"
#include "survey/edits/block_edits.h"
#include "survey/edits/map_edit.h"
#include "survey/grid/raster_strips.h"

namespace survey {

// Beyond these an edit that moved with its scans is to be looked at.
struct RefitLimits {
  double residual_m = 0.15;
  double area_change = 0.10;
};

// The edits that concern the block, where `poses` put them, in the order of application. An edit drawn on the map
// concerns the blocks whose scans drew it there, and those that had no map then; one in site coordinates all of them; a
// mask those whose beams it drops.
std::vector<AppliedEdit> EditsOfBlock(const std::string& block, const std::vector<MapEdit>& edits,
                                      const BlockPoses& poses);

// The part of the block's grid that the edits may reach: a map of any size is edited in its memory.
SiteRaster PartUnder(const std::vector<AppliedEdit>& edits, const RasterStrips& grid);

// Applies them to the block's grid, or that part of it, and fills what they changed.
BlockEdits ApplyEdits(const std::string& block, std::vector<AppliedEdit> edits, const RefitLimits& limits,
                      SiteRaster* grid);

// Of these the edits that a person is asked about, with what was found about them.
BlockEdits Doubtful(const BlockEdits& edits);

}  // namespace survey
