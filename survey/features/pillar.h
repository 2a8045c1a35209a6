// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "survey/features/locate.h"

namespace survey {

// The centre of a free-standing pillar, round (circle through its faces) or with straight faces (middle of opposite
// faces). Of a square pillar three faces must be seen. Sets position, covariance and number of cells, or the reason.
MapFeature LocatePillar(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                        const LocateOptions& options);

}  // namespace survey
