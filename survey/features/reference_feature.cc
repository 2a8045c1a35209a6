// SPDX-License-Identifier: Apache-2.0
#include "survey/features/reference_feature.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "survey/features/reference_pillar.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kGap_m = 0.05;      // from the end of a face to the corner
constexpr double kDistinct_m = 0.1;  // two features must differ this much in their distance from the rough place
constexpr double kTheSame_m = 0.03;  // unless they lie this near to each other

// Places relative to the rough one.
void TakeNearest(std::vector<PointCrossing> candidates, const std::string& none, const ReferenceFeatureOptions& options,
                 const Vector2d& rough, MapFeature* feature) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PointCrossing& a, const PointCrossing& b) { return a.p.norm() < b.p.norm(); });
  if (candidates.empty() || candidates.front().p.norm() > options.search_radius_m) {
    feature->reason = none;
  } else if (std::any_of(candidates.begin() + 1, candidates.end(), [&](const PointCrossing& other) {
               const PointCrossing& nearest = candidates.front();
               return other.p.norm() - nearest.p.norm() < kDistinct_m && (other.p - nearest.p).norm() > kTheSame_m;
             })) {
    feature->reason = "two of them lie about as near to the rough place";
  } else {
    feature->found = true;
    feature->position_in_site = rough + candidates.front().p;
    feature->covariance = candidates.front().covariance;
  }
}

std::vector<PointCrossing> FindCorners(const std::vector<PointLine>& lines) {
  std::vector<PointCrossing> corners;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      const std::optional<PointCrossing> crossing = CrossingOf(lines[i], lines[j]);
      if (crossing && lines[i].ReachesTo(crossing->p, kGap_m) && lines[j].ReachesTo(crossing->p, kGap_m))
        corners.push_back(*crossing);
    }
  }
  return corners;
}

}  // namespace

MapFeature LocateInReference(std::span<const Vector2d> points, const NamedFeature& wanted,
                             const ReferenceFeatureOptions& options) {
  MapFeature feature{.name = wanted.name, .kind = wanted.kind};
  std::vector<Vector2d> near;
  for (const Vector2d& p : points) {
    const Vector2d d = p - wanted.position_in_site;
    if (d.norm() <= options.face_length_m) near.push_back(d);
  }
  feature.num_cells = static_cast<int>(near.size());
  if (feature.num_cells < options.lines.min_points) {
    feature.reason = "the reference has too few points near";
    return feature;
  }
  if (wanted.kind == FeatureKind::kCorner) {
    TakeNearest(FindCorners(FindPointLines(near, options.lines)), "no two faces meet near", options,
                wanted.position_in_site, &feature);
  } else {
    TakeNearest(FindPillars(near, options.lines), "neither a circle nor three faces are seen", options,
                wanted.position_in_site, &feature);
  }
  return feature;
}

}  // namespace survey
