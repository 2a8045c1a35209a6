// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/tracking_map.h"

#include "survey/matching/coarse_search.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

class SurfaceTrackingMap : public TrackingMap {
 public:
  explicit SurfaceTrackingMap(const TrackingMapOptions& options)
      : options_(options), fine_(options.surface_cell_size_m), coarse_(options.coarse_surface_cell_size_m) {}

  void Insert(const Pose2& map_from_scan, const PreparedScan& scan) override {
    fine_.Insert(map_from_scan, scan.surfaces);
    coarse_.Insert(map_from_scan, scan.surfaces);
  }

  MatchResult Match(const PreparedScan& scan, const Pose2& start, const Pose2& predicted,
                    const Eigen::Matrix3d& prediction_covariance, Start kind) const override {
    return MatchToSurfaces(kind == Start::kPredicted ? &coarse_ : nullptr, fine_, scan.surfaces, start, predicted,
                           prediction_covariance, options_.surfaces);
  }

  std::vector<Pose2> Search(const PreparedScan& scan, const Pose2& centre, double half_width_m,
                            double half_angle_rad) const override {
    return SearchSurfaces(fine_, scan.surfaces, centre, half_width_m, half_angle_rad);
  }

 private:
  TrackingMapOptions options_;
  SurfaceMap fine_;
  SurfaceMap coarse_;
};

class OccupancyTrackingMap : public TrackingMap {
 public:
  explicit OccupancyTrackingMap(const TrackingMapOptions& options) : options_(options), grid_(options.grid) {}

  void Insert(const Pose2& map_from_scan, const PreparedScan& scan) override {
    std::vector<Eigen::Vector2f> surface_in_scan;
    SurfacePoints(scan.hits, options_.grid.cell_size_m, kMaxSurfaceGap_m, &surface_in_scan);
    std::vector<Eigen::Vector2f> hits;
    std::vector<Eigen::Vector2f> surface;
    TransformPoints(map_from_scan, scan.hits, &hits);
    TransformPoints(map_from_scan, surface_in_scan, &surface);
    grid_.Insert(map_from_scan.Translation().cast<float>(), hits, {}, surface);
  }

  MatchResult Match(const PreparedScan& scan, const Pose2& start, const Pose2& predicted,
                    const Eigen::Matrix3d& prediction_covariance, Start) const override {
    return MatchScan(grid_, scan.thinned, start, predicted, prediction_covariance, options_.occupancy);
  }

  std::vector<Pose2> Search(const PreparedScan& scan, const Pose2& centre, double half_width_m,
                            double half_angle_rad) const override {
    return CoarseSearch(grid_, scan.thinned, centre, half_width_m, half_angle_rad, {});
  }

 private:
  TrackingMapOptions options_;
  OccupancyPyramid grid_;
};

}  // namespace

std::unique_ptr<TrackingMap> MakeTrackingMap(const TrackingMapOptions& options) {
  if (options.matcher == Matcher::kOccupancy) return std::make_unique<OccupancyTrackingMap>(options);
  return std::make_unique<SurfaceTrackingMap>(options);
}

void PrepareScan(const TrackingMapOptions& options, PreparedScan* scan) {
  const auto max_points = static_cast<std::size_t>(options.max_points);
  if (options.matcher == Matcher::kOccupancy) {
    ThinAlongScan(scan->hits, options.point_spacing_m, max_points, &scan->thinned);
    scan->num_points = scan->thinned.size();
  } else {
    SurfacePointsOfScan(scan->hits, options.point_spacing_m, max_points, &scan->surfaces);
    scan->num_points = scan->surfaces.size();
  }
}

}  // namespace survey
