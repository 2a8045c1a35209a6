// SPDX-License-Identifier: Apache-2.0
//
// Scan-to-map matching on surfaces: point-to-line distances to the nearest surfels under a robust loss, by
// Gauss-Newton, with the predicted pose as a further observation. A wall tells only of the direction across it, so a
// corridor keeps its prediction along it and reports a long ellipse. The default where [CN] eq. (6)-(7)
// (survey/matching/gauss_newton.h) can be chosen instead.
#pragma once

#include <span>
#include <vector>

#include "survey/matching/gauss_newton.h"
#include "survey/matching/surface_map.h"

namespace survey {

struct SurfaceMatchOptions {
  double min_sigma_m = 0.008;      // of one distance; larger where the distances of the scan at hand are
  double independent_share = 0.1;  // of the points: neighbouring beams err alike
  double loss_m = 0.1;             // Cauchy: distances beyond lose weight
  double coarse_loss_m = 0.2;      // of the first steps
  double point_weight = 0.2;       // of points without a normal, against those with
  double inlier_m = 0.1;           // points nearer to a surface count for the score
  int max_iterations = 12;
  double step_m = 2e-4;  // converged below this step
  double step_rad = 2e-5;
};

// Fields of the result as for MatchScan; the score is the share of points that lie on a surface. `coarse` holds the
// same surfaces in larger cells, for a wider reach of the first steps; null: the start is known to be near.
MatchResult MatchToSurfaces(const SurfaceMap* coarse, const SurfaceMap& map,
                            std::span<const SurfacePoint> points_in_scan, const Pose2& start, const Pose2& predicted,
                            const Eigen::Matrix3d& prediction_covariance, const SurfaceMatchOptions& options);

// Poses around `centre` from which most points lie on or beside surfaces of the map, best first, some apart from each
// other: starts for MatchToSurfaces when the prediction is too uncertain. They lie within a cell of the best pose, in
// wide windows within two.
std::vector<Pose2> SearchSurfaces(const SurfaceMap& map, std::span<const SurfacePoint> points_in_scan,
                                  const Pose2& centre, double half_width_m, double half_angle_rad);

}  // namespace survey
