// SPDX-License-Identifier: Apache-2.0
//
// Where robots must not go ([AS] section IV-B, forbidden areas): a mask beside the map, never part of its occupancy.
#pragma once

#include <vector>

#include "survey/edits/map_edit.h"
#include "survey/grid/raster_strips.h"

namespace survey {

// Cells with the log-odds of an edited cell: occupied in forbidden areas, free elsewhere. Strip by strip, on the cells
// of `frame`.
RasterStrips KeepoutStrips(const SiteRaster& frame, std::vector<MapEdit> forbidden);

}  // namespace survey
