// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/rendering.h"

namespace survey {

void TransformPoints(const Pose2& target_from_source, std::span<const Eigen::Vector2f> points,
                     std::vector<Eigen::Vector2f>* transformed) {
  const Eigen::Matrix2f rotation = Rotation2(target_from_source.theta).cast<float>();
  const Eigen::Vector2f translation = target_from_source.Translation().cast<float>();
  transformed->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) (*transformed)[i] = rotation * points[i] + translation;
}

OccupancyPyramid DrawSubmap(const Session& session, const Track& track, const Submap& submap,
                            const ScanProjector& projector, const OccupancyOptions& options) {
  OccupancyPyramid grid(options);
  ScanPoints points;
  std::vector<Eigen::Vector2f> hits;
  std::vector<Eigen::Vector2f> surface;
  std::vector<Eigen::Vector2f> surface_in_scan;
  const auto pose_of = [&](std::size_t i) { return track.scans[i].local_from_scan; };
  for (const ScanId node : submap.nodes) {
    const auto index = static_cast<std::size_t>(node.value);
    projector.Project(session, index, TwistOfScan(session.scans, pose_of, index), &points);
    const Pose2 submap_from_scan = Between(submap.local_from_submap, pose_of(index));
    TransformPoints(submap_from_scan, points.hits, &hits);
    SurfacePoints(points.hits, options.cell_size_m, kMaxSurfaceGap_m, &surface_in_scan);
    TransformPoints(submap_from_scan, surface_in_scan, &surface);
    grid.Insert(submap_from_scan.Translation().cast<float>(), hits, {}, surface);
  }
  return grid;
}

}  // namespace survey
