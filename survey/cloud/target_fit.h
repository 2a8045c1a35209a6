// SPDX-License-Identifier: Apache-2.0
//
// Brings a scanner's frame into the control frame by targets with known coordinates: which sphere is which target by
// their distances, then a rigid fit of three dimensions [Umeyama91]. A scale is estimated and tested, never applied.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace survey {

struct KnownTarget {
  std::string name;
  Eigen::Vector3d position_in_site = Eigen::Vector3d::Zero();  // east, north, elevation; m
  double sigma_m = 0.003;                                      // per axis
};

struct TargetResidual {
  std::string name;
  int sphere = -1;                                     // index of the measured centre
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // site_from_cloud * measured - known
};

struct TargetFit {
  bool usable = false;
  std::string message;  // why not
  Eigen::Isometry3d site_from_cloud = Eigen::Isometry3d::Identity();
  std::vector<TargetResidual> residuals;
  double rms_m = 0.0;        // of the lengths of the residuals
  double scale = 1.0;        // what a similarity fit takes
  double scale_sigma = 0.0;  // of it, from the residuals
  double sigma_m = 0.0;      // of a target, per axis: as listed; by the residuals where they contradict that at 95 %
  Eigen::Vector2d middle_in_site = Eigen::Vector2d::Zero();  // of the targets
  double plan_moment = 0.0;                                  // sum of their squared distances from it, m2

  // Covariance (m2) that the fit gives to whatever the cloud shows at a place: that of its shift and of its turn.
  Eigen::Matrix2d CovarianceAt(const Eigen::Vector2d& p_in_site) const;
};

struct TargetFitOptions {
  double tolerance_m = 0.02;  // of distances between targets, and of residuals
};

// Not usable: fewer than three targets found again, two ways to match them, a mirrored frame (x and y exchanged,
// heights downward), a scale beyond three of its sigmas and 100 ppm (other units).
TargetFit FitTargets(std::span<const Eigen::Vector3d> spheres, std::span<const KnownTarget> targets,
                     const TargetFitOptions& options);

}  // namespace survey
