// SPDX-License-Identifier: Apache-2.0
//
// The improved proposal of a Rao-Blackwellized particle filter, [Grisetti07] section III-B: the scan is matched in the
// particle's own map with the predicted motion as a further observation; around the optimum the product of likelihood
// and motion model is taken as the Gaussian that the normal equations give. Frame: the particle's map; m, rad.
#pragma once

#include <Eigen/Core>
#include <span>

#include "survey/geometry/pose2.h"
#include "survey/matching/surface_match.h"
#include "survey/submaps/tracking_map.h"

namespace survey {

// The map that one particle has drawn. Copies share their tiles.
struct ParticleMap {
  SurfaceMap fine;
  SurfaceMap coarse;  // the same surfaces in larger cells: a wider reach of the first steps

  void Insert(const Pose2& map_from_scan, std::span<const SurfacePoint> points_in_scan) {
    fine.Insert(map_from_scan, points_in_scan);
    coarse.Insert(map_from_scan, points_in_scan);
  }
};

struct ProposalOptions {
  SurfaceMatchOptions match;
  double tempering = 0.3;  // exponent of the weights: scans err alike, so do their beams; for any number of particles
  double sigma_m = 0.05;   // of an end point against the surface that it belongs to, with the error of the map
  double loss_m = 0.1;     // Cauchy
  double unexplained_m = 0.3;  // end points without a surface near count as if they were so far off
  double min_score = 0.2;      // share of points on surfaces below which a match is not believed
};

struct Proposal {
  Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double log_weight = 0.0;  // of the particle: integral of likelihood and motion model, [Grisetti07] eq. (12)
  double score = 0.0;       // share of points on surfaces
  bool matched = false;     // false: the motion model alone
};

// The match starts at `start`, near or as far off as a prediction may be.
Proposal ProposePose(const ParticleMap& map, std::span<const SurfacePoint> points_in_scan, const Pose2& start,
                     Start kind, const Pose2& predicted, const Eigen::Matrix3d& prediction_covariance,
                     const ProposalOptions& options);

// Logarithm of the tempered likelihood of a scan at a pose.
double ScanLogLikelihood(const SurfaceMap& map, std::span<const SurfacePoint> points_in_scan,
                         const Pose2& map_from_scan, const ProposalOptions& options);

// mean + L n with covariance = L L^T and n three standard normal numbers.
Pose2 SamplePose(const Pose2& mean, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& normals);

}  // namespace survey
