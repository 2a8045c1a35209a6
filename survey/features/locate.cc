// SPDX-License-Identifier: Apache-2.0
#include "survey/features/locate.h"

#include <cmath>
#include <cstdio>

#include "survey/features/corner.h"
#include "survey/features/pillar.h"

namespace survey {

MapFeature LocateFeature(const SiteRaster& map, const NamedFeature& wanted, const LocateOptions& options) {
  MapFeature feature =
      wanted.kind == FeatureKind::kCorner ? LocateCorner(map, wanted, options) : LocatePillar(map, wanted, options);
  const double distance_m = (feature.position_in_site - wanted.position_in_site).norm();
  if (feature.reason.empty() && distance_m > options.certain_m) {
    char text[96];
    std::snprintf(text, sizeof text, "the nearest %s is %.2f m from the surveyed place: it may be another one",
                  std::string(Name(wanted.kind)).c_str(), distance_m);
    feature = {.reason = text};
  }
  feature.name = wanted.name;
  feature.kind = wanted.kind;
  feature.found = feature.reason.empty();
  if (feature.found)
    feature.covariance += std::pow(options.scatter_cells * map.cell_size_m, 2) * Eigen::Matrix2d::Identity();
  return feature;
}

}  // namespace survey
