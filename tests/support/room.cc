// SPDX-License-Identifier: Apache-2.0
#include "tests/support/room.h"

#include <cmath>
#include <numbers>

#include "survey/stats/philox.h"

namespace test_support {

using Eigen::Vector2d;

std::vector<Wall> Outline(const std::vector<Vector2d>& corners) {
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < corners.size(); ++i) walls.push_back({corners[i], corners[(i + 1) % corners.size()]});
  return walls;
}

std::vector<Wall> FurnishedRoom() {
  std::vector<Wall> walls = Outline({{-6, -4}, {6, -4}, {6, 4}, {2, 4}, {2, 5.5}, {-0.5, 5.5}, {-0.5, 4}, {-6, 4}});
  for (const Wall& wall : Outline({{-3, -1.2}, {-2.5, -1.2}, {-2.5, -0.7}, {-3, -0.7}})) walls.push_back(wall);
  for (const Wall& wall : Outline({{3.2, 1.1}, {3.6, 1.1}, {3.6, 2.0}, {3.2, 2.0}})) walls.push_back(wall);
  return walls;
}

std::vector<Wall> Ring() {
  std::vector<Wall> walls = Outline({{-12, -9}, {12, -9}, {12, 9}, {-12, 9}});
  for (const auto& wall : Outline({{-9, -6},
                                   {-2, -6},
                                   {-2, -5},
                                   {-1, -5},
                                   {-1, -6},
                                   {9, -6},
                                   {9, 6},
                                   {3, 6},
                                   {3, 5.2},
                                   {1.5, 5.2},
                                   {1.5, 6},
                                   {-9, 6},
                                   {-9, 2},
                                   {-8.4, 2},
                                   {-8.4, 1},
                                   {-9, 1}}))
    walls.push_back(wall);
  for (const auto& wall : Outline({{5, 8.6}, {5.5, 8.6}, {5.5, 9}, {5, 9}})) walls.push_back(wall);
  for (const auto& wall : Outline({{-5, -9}, {-4.2, -9}, {-4.2, -8.5}, {-5, -8.5}})) walls.push_back(wall);
  for (const auto& wall : Outline({{11.5, -2}, {12, -2}, {12, -1}, {11.5, -1}})) walls.push_back(wall);
  return walls;
}

std::vector<survey::Pose2> LapsOfTheRing(int laps) {
  const std::vector<Eigen::Vector2d> corners = {{-10.5, -7.5}, {10.5, -7.5}, {10.5, 7.5}, {-10.5, 7.5}};
  std::vector<survey::Pose2> poses;
  for (int k = 0; k < 4 * laps; ++k) {
    const Eigen::Vector2d from = corners[static_cast<std::size_t>(k % 4)];
    const Eigen::Vector2d to = corners[static_cast<std::size_t>((k + 1) % 4)];
    const double heading = std::atan2(to.y() - from.y(), to.x() - from.x());
    const int steps = static_cast<int>((to - from).norm() / 0.1);
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d p = from + (to - from) * (static_cast<double>(i) / steps);
      poses.push_back({p.x(), p.y(), heading});
    }
    for (int i = 0; i < 15; ++i) poses.push_back({to.x(), to.y(), heading + i * 0.1047});
  }
  return poses;
}

std::vector<float> SimulateRanges(const std::vector<Wall>& walls, const survey::Pose2& world_from_lidar,
                                  const survey::ScanGeometry& geometry, double sigma_m, std::uint32_t seed) {
  const survey::RandomStream noise(20, 1, seed);
  std::vector<float> ranges;
  for (int i = 0; i < geometry.num_beams; ++i) {
    const double angle = world_from_lidar.theta + geometry.angle_min_rad + i * geometry.angle_increment_rad;
    const Vector2d direction(std::cos(angle), std::sin(angle));
    double nearest = geometry.range_max_m;
    for (const Wall& wall : walls) {
      const Vector2d along = wall.b - wall.a;
      const Vector2d offset = wall.a - world_from_lidar.Translation();
      const double cross = direction.x() * along.y() - direction.y() * along.x();
      if (std::abs(cross) < 1e-12) continue;
      const double range = (offset.x() * along.y() - offset.y() * along.x()) / cross;
      const double place = (offset.x() * direction.y() - offset.y() * direction.x()) / cross;
      if (range > 0 && range < nearest && place >= 0 && place <= 1) nearest = range;
    }
    const bool hit = nearest < geometry.range_max_m;
    ranges.push_back(hit ? static_cast<float>(nearest + sigma_m * noise.Normal(static_cast<std::uint64_t>(i)))
                         : survey::kNoReturn);
  }
  return ranges;
}

survey::ScanGeometry WideScanner(int num_beams) {
  const double fov = 1.5 * std::numbers::pi;
  return {.angle_min_rad = -0.5 * fov,
          .angle_increment_rad = fov / (num_beams - 1),
          .time_increment_s = 0.0,
          .range_min_m = 0.1,
          .range_max_m = 30.0,
          .num_beams = num_beams};
}

survey::Session SimulateSession(const std::vector<Wall>& walls, const std::vector<survey::Pose2>& world_from_lidar,
                                double rate_hz, double sigma_m, double odometry_scale, double odometry_bias_rad_per_m) {
  survey::Session session;
  session.geometries = {WideScanner(271)};
  survey::Pose2 odometry;
  for (std::size_t i = 0; i < world_from_lidar.size(); ++i) {
    const auto stamp = static_cast<survey::StampNs>(std::llround(1e9 * static_cast<double>(i) / rate_hz));
    session.scans.push_back({stamp, 0,
                             SimulateRanges(walls, world_from_lidar[i], session.geometries.front(), sigma_m,
                                            static_cast<std::uint32_t>(i))});
    if (i > 0) {
      survey::Pose2 motion = survey::Between(world_from_lidar[i - 1], world_from_lidar[i]);
      motion.theta += odometry_bias_rad_per_m * motion.Translation().norm();
      motion.x *= odometry_scale;
      motion.y *= odometry_scale;
      odometry = odometry * motion;
    }
    session.odometry.push_back({stamp, odometry});
  }
  return session;
}

}  // namespace test_support
