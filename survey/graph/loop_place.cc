// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/loop_place.h"

#include <algorithm>
#include <limits>

#include "survey/submaps/rendering.h"

namespace survey {
namespace {

constexpr int kSearchLevels = 7;
constexpr std::size_t kOwnScans = 10;  // of the submap's nodes tell its usual score

void ProjectScan(const Session& session, const Track& track, ScanId scan, const ScanProjector& projector,
                 ScanPoints* points) {
  const auto index = static_cast<std::size_t>(scan.value);
  const auto pose_of = [&](std::size_t i) { return track.scans[i].local_from_scan; };
  projector.Project(session, index, TwistOfScan(session.scans, pose_of, index), points);
}

OccupancyOptions GridOptions(const PlaceOptions& options) {
  OccupancyOptions grid;
  grid.cell_size_m = options.search_cell_size_m;
  grid.num_levels = 1;
  return grid;
}

}  // namespace

std::vector<ScanId> SpacedNodes(const Track& track, double spacing_m) {
  std::vector<ScanId> marked;
  for (const TrackedMark& mark : track.marks) marked.push_back(mark.scan);
  std::sort(marked.begin(), marked.end());
  std::vector<ScanId> nodes;
  double way = std::numeric_limits<double>::max();
  const TrackedScan* last = nullptr;
  for (const TrackedScan& scan : track.scans) {
    if (!scan.is_node) continue;
    if (last != nullptr) way += Between(last->local_from_scan, scan.local_from_scan).Translation().norm();
    last = &scan;
    if (way < spacing_m && !std::binary_search(marked.begin(), marked.end(), scan.scan)) continue;
    nodes.push_back(scan.scan);
    way = 0.0;
  }
  return nodes;
}

PlaceScan PrepareForPlaces(const Session& session, const Track& track, ScanId scan, const ScanProjector& projector,
                           const PlaceOptions& options) {
  ScanPoints points;
  ProjectScan(session, track, scan, projector, &points);
  PlaceScan prepared;
  SurfacePointsOfScan(points.hits, options.point_spacing_m, static_cast<std::size_t>(options.max_points), &prepared);
  return prepared;
}

Place::Place(const Session& session, const Track& track, const Submap& submap, const ScanProjector& projector,
             const PlaceOptions& options, double max_half_width_m)
    : options_(options),
      grid_(GridOptions(options)),
      surfaces_(options.surface_cell_size_m),
      coarse_surfaces_(options.coarse_surface_cell_size_m) {
  struct Drawn {
    PlaceScan scan;
    Pose2 submap_from_scan;
  };
  const auto drawn_every = static_cast<std::size_t>(options.draw_every);
  const std::size_t num_drawn = (submap.nodes.size() + drawn_every - 1) / drawn_every;
  const std::size_t own_every = (num_drawn + kOwnScans - 1) / kOwnScans;
  std::vector<Drawn> own;
  ScanPoints points;
  std::vector<Eigen::Vector2f> hits;
  std::vector<Eigen::Vector2f> between;
  std::vector<Eigen::Vector2f> between_in_submap;
  PlaceScan scan;
  for (std::size_t i = 0; i < num_drawn; ++i) {
    const ScanId node = submap.nodes[i * drawn_every];
    const Pose2 submap_from_scan =
        Between(submap.local_from_submap, track.scans[static_cast<std::size_t>(node.value)].local_from_scan);
    ProjectScan(session, track, node, projector, &points);
    TransformPoints(submap_from_scan, points.hits, &hits);
    SurfacePoints(points.hits, options.search_cell_size_m, kMaxSurfaceGap_m, &between);
    TransformPoints(submap_from_scan, between, &between_in_submap);
    grid_.Insert(submap_from_scan.Translation().cast<float>(), hits, {}, between_in_submap);
    SurfacePointsOfScan(points.hits, options.point_spacing_m, static_cast<std::size_t>(options.max_points), &scan);
    surfaces_.Insert(submap_from_scan, scan);
    coarse_surfaces_.Insert(submap_from_scan, scan);
    if (i % own_every == 0) own.push_back({scan, submap_from_scan});
  }
  if (max_half_width_m > 0.0) search_.emplace(grid_, 0, kSearchLevels, max_half_width_m);
  for (const Drawn& drawn : own)
    own_score_ += Overlap(drawn.scan, drawn.submap_from_scan).occupancy / static_cast<double>(own.size());
}

double Place::LeastScore(double share, double occupancy) const {
  return share * occupancy + (1.0 - share) * static_cast<double>(grid_.OccupancyOf(OccupancyPyramid::kUnknown));
}

std::optional<SearchResult> Place::Search(const PlaceScan& scan, const Pose2& centre,
                                          const SearchWindow& window) const {
  if (!search_ || TooFewPoints(scan)) return std::nullopt;
  const auto max_points = static_cast<std::size_t>(options_.max_search_points);
  const std::size_t stride = (scan.size() + max_points - 1) / max_points;
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = 0; i < scan.size(); i += stride) points.push_back(scan[i].position);
  return BranchAndBound(*search_, points, centre, window);
}

MatchResult Place::Match(const PlaceScan& scan, const Pose2& start, const Pose2& predicted,
                         const Eigen::Matrix3d& prediction_covariance) const {
  if (TooFewPoints(scan)) return {};
  return MatchToSurfaces(&coarse_surfaces_, surfaces_, scan, start, predicted, prediction_covariance, options_.match);
}

PlaceOverlap Place::Overlap(const PlaceScan& scan, const Pose2& submap_from_scan) const {
  const Eigen::Matrix2f rotation = Rotation2(submap_from_scan.theta).cast<float>();
  const Eigen::Vector2f translation = submap_from_scan.Translation().cast<float>();
  const auto cells_per_m = static_cast<float>(1.0 / grid_.cell_size_m());
  double seen = 0.0;
  double sum = 0.0;
  for (const SurfacePoint& point : scan) {
    const Eigen::Vector2f p = cells_per_m * (rotation * point.position + translation);
    const OccupancyPyramid::Evidence evidence =
        grid_.At(0, static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
    if (evidence == OccupancyPyramid::kUnknown) continue;
    seen += 1.0;
    sum += static_cast<double>(grid_.OccupancyOf(evidence));
  }
  return {scan.empty() ? 0.0 : seen / static_cast<double>(scan.size()), seen > 0.0 ? sum / seen : 0.0};
}

}  // namespace survey
