// SPDX-License-Identifier: Apache-2.0
//
// Sphere targets of known radius in a scanner's cloud. Candidates by random samples in small boxes [Fischler81],
// centres by least squares on the points of the surface.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace survey {

struct SphereTarget3 {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // frame of the cloud, m
  double rms_m = 0.0;                                // of the distances of its points from the surface
  int num_points = 0;
};

struct SphereSearchOptions {
  double radius_m = 0.0725;
  double tolerance_m = 0.008;  // of a point from the surface
  int min_points = 60;
};

// In order of their number of points. Deterministic.
std::vector<SphereTarget3> FindSpheres(std::span<const Eigen::Vector3f> cloud, const SphereSearchOptions& options);

}  // namespace survey
