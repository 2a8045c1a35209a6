// SPDX-License-Identifier: Apache-2.0
//
// The growing map of a submap that scans are matched in while the block is tracked, in the submap's frame: surfaces
// below the cell (the default), or the occupancy pyramid with [CN] eq. (6)-(7) as written.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "survey/grid/occupancy_pyramid.h"
#include "survey/matching/gauss_newton.h"
#include "survey/matching/surface_match.h"
#include "survey/sensors/scan_points.h"

namespace survey {

// How far the start of a match may be off: as a prediction is, or by about a cell.
enum class Start { kPredicted, kNear };

enum class Matcher { kSurfaces, kOccupancy };

struct TrackingMapOptions {
  Matcher matcher = Matcher::kSurfaces;
  SurfaceMatchOptions surfaces;
  double surface_cell_size_m = 0.1;
  double coarse_surface_cell_size_m = 0.4;
  OccupancyOptions grid;  // of the occupancy pyramid
  MatchOptions occupancy;
  double point_spacing_m = 0.05;  // end points closer along the scan are thinned for matching
  int max_points = 250;           // for matching
};

// A scan made ready for matching and drawing, in its own frame.
struct PreparedScan {
  std::vector<Eigen::Vector2f> hits;
  std::vector<Eigen::Vector2f> thinned;  // for the occupancy matcher
  std::vector<SurfacePoint> surfaces;    // for the surface matcher
  std::size_t num_points = 0;            // to be matched
};

class TrackingMap {
 public:
  virtual ~TrackingMap() = default;
  virtual void Insert(const Pose2& map_from_scan, const PreparedScan& scan) = 0;
  virtual MatchResult Match(const PreparedScan& scan, const Pose2& start, const Pose2& predicted,
                            const Eigen::Matrix3d& prediction_covariance, Start kind) const = 0;
  // Poses that explain the scan best in a window around `centre`, best first: starts for Match.
  virtual std::vector<Pose2> Search(const PreparedScan& scan, const Pose2& centre, double half_width_m,
                                    double half_angle_rad) const = 0;
};

std::unique_ptr<TrackingMap> MakeTrackingMap(const TrackingMapOptions& options);

// Fills what the matcher of the options needs from `scan->hits`.
void PrepareScan(const TrackingMapOptions& options, PreparedScan* scan);

}  // namespace survey
