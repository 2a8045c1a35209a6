// SPDX-License-Identifier: Apache-2.0
//
// Small worlds of wall segments with exact ranges, for tests of matching and tracking.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace test_support {

struct Wall {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

// Closed outline through the points.
std::vector<Wall> Outline(const std::vector<Eigen::Vector2d>& corners);

// A room of 12 m x 8 m with an alcove and two pillars: no symmetry, every direction determined.
std::vector<Wall> FurnishedRoom();

// A ring of four corridors, 3 m wide, with niches so that no corridor is featureless; and the platform's way around it.
std::vector<Wall> Ring();
std::vector<survey::Pose2> LapsOfTheRing(int laps);

// Ranges of a scanner with the given geometry at a pose, exact but for `sigma_m` of normal noise (numbered by `seed`).
std::vector<float> SimulateRanges(const std::vector<Wall>& walls, const survey::Pose2& world_from_lidar,
                                  const survey::ScanGeometry& geometry, double sigma_m, std::uint32_t seed);

// 270 degrees, `num_beams` beams, 30 m, all at one instant.
survey::ScanGeometry WideScanner(int num_beams);

// A session of scans along a path of poses, `rate_hz` apart, with odometry that slips by the given factor in distance
// and turns by `odometry_bias_rad_per_m`.
survey::Session SimulateSession(const std::vector<Wall>& walls, const std::vector<survey::Pose2>& world_from_lidar,
                                double rate_hz, double sigma_m, double odometry_scale, double odometry_bias_rad_per_m);

}  // namespace test_support
