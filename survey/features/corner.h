// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "survey/features/locate.h"

namespace survey {

// The corner of two wall faces: their intersection. Sets position, covariance and number of cells, or the reason.
MapFeature LocateCorner(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                        const LocateOptions& options);

}  // namespace survey
