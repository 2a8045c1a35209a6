// SPDX-License-Identifier: Apache-2.0
//
// Finds named features in an occupancy raster, starting from their surveyed places, and reads where they are from the
// hits that drew it; `covariance` is left to whoever knows that of the poses. What is not seen, or could be two
// things, is reported so with the reason, never guessed. A corner of a pillar that is not seen must not be taken for
// the next one, half a metre away.
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include "survey/features/feature.h"
#include "survey/grid/hit_cells.h"
#include "survey/grid/site_raster.h"

namespace survey {

struct LocateOptions {
  double search_radius_m = 0.6;  // a feature is looked for this far from its surveyed place
  double certain_m = 0.25;       // farther away it may be another one: reported, not taken
  double face_length_m = 0.8;    // faces are followed this far from a corner
  double min_face_m = 0.25;      // shorter faces do not count
  double max_gap_m = 0.2;        // from the end of a face to the corner
  double distinct_m = 0.1;       // two possible corners must differ this much in their distance from the surveyed place
  double max_pillar_size_m = 1.5;
  double max_sigma_cells = 0.5;  // in the worst direction; what is read less surely is reported, not taken

  // How far from a feature cells are looked at.
  double CornerReach() const { return search_radius_m + face_length_m; }
  double PillarReach() const { return search_radius_m + max_pillar_size_m * std::numbers::sqrt2 / 2; }
  double Reach() const { return std::max(CornerReach(), PillarReach()); }
};

// No place is read for two features: of those that lie within same_place_m of each other none is taken, and each says
// which one the other is.
void RefuseSharedPlaces(double same_place_m, std::vector<MapFeature>* features);

// `hits` must hold those within Reach() of the feature.
MapFeature LocateFeature(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                         const LocateOptions& options);

}  // namespace survey
