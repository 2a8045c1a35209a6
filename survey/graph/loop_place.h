// SPDX-License-Identifier: Apache-2.0
//
// A submap as the loop search sees it, drawn anew from its nodes at their poses of the track: what has been seen there
// and where it is occupied, for branch and bound and for the verdict, and its surfaces, for the pose below the cell.
// Frame: the submap's, metres.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "survey/grid/occupancy_pyramid.h"
#include "survey/matching/branch_and_bound.h"
#include "survey/matching/surface_match.h"
#include "survey/sensors/scan_points.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace survey {

struct PlaceOptions {
  double search_cell_size_m = 0.1;   // of branch and bound
  double surface_cell_size_m = 0.1;  // as in the track
  double coarse_surface_cell_size_m = 0.4;
  SurfaceMatchOptions match;
  int draw_every = 3;  // nodes of a submap lie densely: every so many draw it
  double point_spacing_m = 0.05;
  int max_points = 180;        // to draw and match
  int max_search_points = 60;  // for branch and bound
  int min_points = 20;         // a scan of fewer lies well in too many ways: it is neither searched nor matched
};

// Nodes of the track at least spacing_m apart along it, and those that carry marks.
std::vector<ScanId> SpacedNodes(const Track& track, double spacing_m);

// A scan of the track made ready for places.
using PlaceScan = std::vector<SurfacePoint>;
PlaceScan PrepareForPlaces(const Session& session, const Track& track, ScanId scan, const ScanProjector& projector,
                           const PlaceOptions& options);

// How a scan lies on a place.
struct PlaceOverlap {
  double share = 0.0;      // of the points on cells that the submap has seen
  double occupancy = 0.0;  // mean of these cells, 0..1
};

class Place {
 public:
  // For windows up to max_half_width_m; 0: no search, only matches.
  Place(const Session& session, const Track& track, const Submap& submap, const ScanProjector& projector,
        const PlaceOptions& options, double max_half_width_m);

  // Mean occupancy of the submap's own nodes: what a scan that belongs here reaches.
  double own_score() const { return own_score_; }

  // Score of a search that a scan has at least when this share of it lies on cells seen, of this mean occupancy.
  double LeastScore(double share, double occupancy) const;

  // Best pose in the window around `centre`; the score is relative to all points, seen or not. Empty where there is
  // none or the scan has too few points.
  std::optional<SearchResult> Search(const PlaceScan& scan, const Pose2& centre, const SearchWindow& window) const;

  // Pose below the cell near `start`; not usable with too few points.
  MatchResult Match(const PlaceScan& scan, const Pose2& start, const Pose2& predicted,
                    const Eigen::Matrix3d& prediction_covariance) const;

  PlaceOverlap Overlap(const PlaceScan& scan, const Pose2& submap_from_scan) const;

 private:
  bool TooFewPoints(const PlaceScan& scan) const { return std::ssize(scan) < options_.min_points; }

  const PlaceOptions& options_;
  OccupancyPyramid grid_;
  std::optional<SlidingMaximumGrids> search_;
  SurfaceMap surfaces_;
  SurfaceMap coarse_surfaces_;
  double own_score_ = 0.0;
};

}  // namespace survey
