// SPDX-License-Identifier: Apache-2.0
//
// Positional uncertainty of a block's map, cell by cell, from the covariances of the poses that drew it.
#pragma once

#include "survey/graph/solution.h"
#include "survey/grid/site_raster.h"

namespace survey {

// Fills raster->sigma_m for all known cells: the covariance of the nearest pose that has one, carried over to the cell
// (rotation included); its larger semi-axis, m. The range noise of the lidar is not in it. Where the solution has no
// covariances nothing is filled.
void FillSigmas(const Solution& solution, SiteRaster* raster);

}  // namespace survey
