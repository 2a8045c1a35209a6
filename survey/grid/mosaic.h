// SPDX-License-Identifier: Apache-2.0
//
// Block maps put together on the site's cell raster ([CN] section 2.4: blocks that are tied to the same control land in
// one coordinate system and are not matched to each other). Per cell the sum of the blocks' log-odds (independent
// observations), clamped; NaN where no block saw the cell. A cell's sigma is the largest of the blocks that saw it;
// there is none when a block has none.
#pragma once

#include <span>
#include <vector>

#include "survey/grid/raster_strips.h"
#include "survey/grid/site_raster.h"

namespace survey {

struct MosaicOptions {
  float min_log_odds = -4.0F;  // the sum over the blocks is clamped to this
  float max_log_odds = 4.0F;
};

// The common bounding box of the blocks, strip by strip; each block is asked for the rows that it has. All rasters must
// have the same cell size. Empty without blocks.
RasterStrips MosaicOf(std::vector<RasterStrips> blocks, const MosaicOptions& options);

// The same in memory.
SiteRaster Mosaic(std::span<const SiteRaster* const> blocks, const MosaicOptions& options);

}  // namespace survey
