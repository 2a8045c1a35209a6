// SPDX-License-Identifier: Apache-2.0
#include "survey/features/corner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "survey/features/face_lines.h"
#include "survey/features/feature.h"

namespace survey {
namespace {

using Eigen::Vector2d;

struct Corner {
  Vector2d p;  // from the surveyed place
  Eigen::Matrix2d covariance;
  int num_cells = 0;
};

// Distance from the end of a face to a place along it, 0 within the face.
double GapTo(const FaceLine& line, double along) { return std::max({0.0, line.begin - along, along - line.end}); }

// The part of a face on the longer side of a place.
double ReachBeyond(const FaceLine& line, double along) { return std::max(line.end - along, along - line.begin); }

std::vector<Corner> CornersOf(const std::vector<FaceLine>& lines, const LocateOptions& options) {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      Eigen::Matrix2d normals;
      normals << lines[i].normal.transpose(), lines[j].normal.transpose();
      if (std::abs(normals.determinant()) < kMinSineOfCorner) continue;
      const Eigen::Matrix2d inverse = normals.inverse();
      const Vector2d p = inverse * Vector2d(lines[i].offset, lines[j].offset);
      bool meets = p.norm() <= options.search_radius_m;
      Vector2d variances;
      for (const auto& [line, k] : {std::pair{&lines[i], 0}, std::pair{&lines[j], 1}}) {
        const double along = line->Along().dot(p);
        meets = meets && GapTo(*line, along) <= options.max_gap_m && ReachBeyond(*line, along) >= options.min_face_m;
        variances(k) = std::pow(line->SigmaAt(along), 2);
      }
      if (!meets) continue;
      corners.push_back(
          {p, inverse * variances.asDiagonal() * inverse.transpose(), lines[i].num_cells + lines[j].num_cells});
    }
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.p.norm() < b.p.norm(); });
  return corners;
}

}  // namespace

MapFeature LocateCorner(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                        const LocateOptions& options) {
  MapFeature feature;
  const double reach = options.CornerReach();
  const std::vector<FaceCell> cells = FaceCellsNear(map, wanted.position_in_site, reach);
  if (cells.empty()) {
    feature.reason = "no wall of the map lies near";
    return feature;
  }
  const std::vector<FaceLine> lines = FindFaceLines(cells, hits.Near(wanted.position_in_site, reach), map.cell_size_m,
                                                    {.min_length_m = options.min_face_m, .max_lines = 12});
  const std::vector<Corner> corners = CornersOf(lines, options);
  if (corners.empty()) {
    feature.reason = lines.size() < 2 ? "fewer than two wall faces are seen" : "no two wall faces meet near";
    return feature;
  }
  if (corners.size() > 1 && corners[1].p.norm() - corners[0].p.norm() < options.distinct_m) {
    feature.reason = "two corners lie about as near to the surveyed place";
    return feature;
  }
  feature.position_in_site = wanted.position_in_site + corners.front().p;
  feature.reading = corners.front().covariance;
  feature.num_cells = corners.front().num_cells;
  return feature;
}

}  // namespace survey
