// SPDX-License-Identifier: Apache-2.0
//
// End points of a scan's beams in the lidar frame at the scan's stamp, corrected for the motion during the sweep.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace survey {

// Velocity of the lidar in its own frame, constant over one sweep: m/s, m/s, rad/s.
struct Twist2 {
  double vx = 0.0;
  double vy = 0.0;
  double omega = 0.0;
};

// Twist that moves from a to b (both in one frame) in dt_s; zero when dt_s is not positive.
Twist2 TwistBetween(const Pose2& frame_from_a, const Pose2& frame_from_b, double dt_s);

struct ScanPoints {
  std::vector<Eigen::Vector2f> hits;       // m, in the lidar frame at the scan's stamp
  std::vector<Eigen::Vector2f> free_ends;  // ends of the free rays of beams without return
  std::vector<float> ranges_m;             // where ranges that are not in memory are read to
};

// Turns ranges into points. Keeps the directions of the beams of each geometry, so use one per session.
class ScanProjector {
 public:
  // Beams without return count as free up to free_range_m; 0 leaves them out. Hits beyond max_range_m are left out and
  // count as free up to there.
  ScanProjector(std::span<const ScanGeometry> geometries, double max_range_m, double free_range_m);

  // `points` is overwritten (its memory is reused). `level_from_lidar` projects the plane of the scan to the horizontal
  // (columns: the lidar's x and y axes seen from above, its heading zero).
  void Project(const Session& session, std::size_t scan, const Twist2& twist, ScanPoints* points,
               const Eigen::Matrix2d& level_from_lidar = Eigen::Matrix2d::Identity()) const;
  void Project(int geometry, std::span<const float> ranges_m, const Twist2& twist, ScanPoints* points,
               const Eigen::Matrix2d& level_from_lidar = Eigen::Matrix2d::Identity()) const;

 private:
  struct Directions {
    ScanGeometry geometry;
    std::vector<Eigen::Vector2f> unit;  // per beam
  };
  std::vector<Directions> directions_;
  float max_range_m_;
  float free_range_m_;
};

// Thins points that lie densely along the scan: keeps those at least spacing_m apart from the last kept one, with the
// spacing doubled until at most max_points remain.
void ThinAlongScan(std::span<const Eigen::Vector2f> points, double spacing_m, std::size_t max_points,
                   std::vector<Eigen::Vector2f>* thinned);

// Points every spacing_m on the surfaces between neighbouring hits: where two hits in a row are at most max_gap_m apart
// and lie on one line with the hit before or after. A sparse scan then draws walls instead of dots, to which the same
// beams of the next scan would stick.
void SurfacePoints(std::span<const Eigen::Vector2f> hits, double spacing_m, double max_gap_m,
                   std::vector<Eigen::Vector2f>* surface);

}  // namespace survey
