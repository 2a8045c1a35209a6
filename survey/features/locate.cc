// SPDX-License-Identifier: Apache-2.0
#include "survey/features/locate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "survey/features/corner.h"
#include "survey/features/pillar.h"
#include "survey/geometry/principal_axes.h"

namespace survey {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[96];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// Why what was found is not taken; empty when it is.
std::string Doubt(const MapFeature& feature, const NamedFeature& wanted, double max_sigma_m, double certain_m) {
  const double distance_m = (feature.position_in_site - wanted.position_in_site).norm();
  if (distance_m > certain_m)
    return Format("the nearest %s is %.2f m from the surveyed place: it may be another one", Name(wanted.kind).data(),
                  distance_m);
  const double sigma_m = std::sqrt(PrincipalAxesOf(feature.reading).values[1]);
  if (sigma_m > max_sigma_m) return Format("too few hits: the place would be uncertain by %.0f mm", 1000 * sigma_m);
  return "";
}

}  // namespace

MapFeature LocateFeature(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                         const LocateOptions& options) {
  MapFeature feature = wanted.kind == FeatureKind::kCorner ? LocateCorner(map, hits, wanted, options)
                                                           : LocatePillar(map, hits, wanted, options);
  if (feature.reason.empty()) {
    const std::string doubt = Doubt(feature, wanted, options.max_sigma_cells * map.cell_size_m, options.certain_m);
    if (!doubt.empty()) feature = {.reason = doubt};
  }
  feature.name = wanted.name;
  feature.kind = wanted.kind;
  feature.found = feature.reason.empty();
  return feature;
}

void RefuseSharedPlaces(double same_place_m, std::vector<MapFeature>* features) {
  const std::vector<MapFeature> all = *features;
  for (MapFeature& feature : *features) {
    if (!feature.found) continue;
    const auto other = std::find_if(all.begin(), all.end(), [&](const MapFeature& each) {
      return each.found && each.name != feature.name &&
             (each.position_in_site - feature.position_in_site).norm() <= same_place_m;
    });
    if (other == all.end()) continue;
    feature = {.name = feature.name, .kind = feature.kind, .reason = "read at the same place as " + other->name};
  }
}

}  // namespace survey
