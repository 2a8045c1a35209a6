// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "survey/simulation/rig.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

StampNs Nanoseconds(double time_s) { return std::llround(time_s * 1e9); }

}  // namespace

ScanGeometry GeometryOf(const LidarSpec& lidar) {
  return {.angle_min_rad = -lidar.field_of_view_rad / 2,
          .angle_increment_rad = lidar.field_of_view_rad / (lidar.num_beams - 1),
          .time_increment_s = lidar.time_increment_s,
          .range_min_m = lidar.range_min_m,
          .range_max_m = lidar.range_max_m,
          .num_beams = lidar.num_beams};
}

WalkState WalkAt(const Person& person, double phase_m, double time_s) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < person.path.size(); ++i) length += (person.path[i + 1] - person.path[i]).norm();
  double s = std::fmod(phase_m + person.speed_m_s * time_s, 2.0 * length);
  const bool back = s > length;
  if (back) s = 2.0 * length - s;
  for (std::size_t i = 0; i + 1 < person.path.size(); ++i) {
    const Vector2d run = person.path[i + 1] - person.path[i];
    if (s <= run.norm() || i + 2 == person.path.size()) {
      const Vector2d forward = run.normalized();
      return {person.path[i] + s * forward, (back ? -person.speed_m_s : person.speed_m_s) * forward};
    }
    s -= run.norm();
  }
  return {person.path.front(), Vector2d::Zero()};
}

SimulatedLidar::SimulatedLidar(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                               const Trajectory& trajectory)
    : scenario_(scenario), block_(block), building_(building), trajectory_(trajectory) {
  const double last_start = trajectory.end_s() - 1.0 / scenario.lidar.rate_hz;
  num_scans_ = static_cast<std::int64_t>(std::floor((last_start - block.start_s) * scenario.lidar.rate_hz)) + 1;
  const ScanGeometry geometry = GeometryOf(scenario.lidar);
  for (int i = 0; i < geometry.num_beams; ++i) {
    const double angle = geometry.angle_min_rad + i * geometry.angle_increment_rad;
    beam_directions_.emplace_back(std::cos(angle), std::sin(angle));
  }
}

StampNs SimulatedLidar::StampOf(std::int64_t scan) const {
  return Nanoseconds(block_.start_s + static_cast<double>(scan) / scenario_.lidar.rate_hz);
}

// Those in reach; somebody next to the cart steps aside.
std::vector<SimulatedLidar::Walker> SimulatedLidar::WalkersAt(double time_s, const Vector2d& near) const {
  const RandomStream random(scenario_.seed, static_cast<std::uint32_t>(SimulationPurpose::kPeople), 0);
  std::vector<Walker> walkers;
  for (std::size_t i = 0; i < scenario_.people.size(); ++i) {
    const Person& person = scenario_.people[i];
    const WalkState state = WalkAt(person, random.Uniform(i, 0.0, 100.0), time_s);
    const double distance = (state.position - near).norm();
    if (distance < scenario_.lidar.range_max_m + 1.0 && distance > person.radius_m + 0.3)
      walkers.push_back({{state.position, person.radius_m}, state.velocity});
  }
  return walkers;
}

// The motion within a sweep: a parabola through the exact motion at its beginning, middle and end.
struct SimulatedLidar::Sweep {
  Eigen::Vector3d at_start;  // x, y, yaw of the lidar
  Eigen::Vector3d linear;
  Eigen::Vector3d square;

  Sweep(const Trajectory& trajectory, double start, double duration) {
    const auto state = [&](double time) {
      const MotionState motion = trajectory.At(time);
      return Eigen::Vector3d(motion.value[0], motion.value[1], motion.value[3] + trajectory.body_from_lidar().theta);
    };
    at_start = state(start);
    const Eigen::Vector3d middle = state(start + duration / 2) - at_start;
    const Eigen::Vector3d end = state(start + duration) - at_start;
    linear = 4.0 * middle - end;
    square = 2.0 * end - 4.0 * middle;
  }
  Eigen::Vector3d At(double fraction) const { return at_start + fraction * (linear + fraction * square); }
};

// Planar range of a beam; NaN and infinity as in Ranges().
double SimulatedLidar::Range(const Vector2d& origin, const Vector2d& direction, double after_s,
                             const std::vector<Walker>& walkers, std::uint64_t beam) const {
  RayHit hit = building_.Cast(origin, direction, scenario_.lidar.range_max_m);
  for (const Walker& walker : walkers) {
    const Disc disc{walker.disc.centre + after_s * walker.velocity, walker.disc.radius_m};
    hit.range_m = std::min(hit.range_m, RangeToDisc(origin, direction, disc));
  }
  if (hit.num_panes == 0) return hit.range_m;
  const RandomStream chance(scenario_.seed, static_cast<std::uint32_t>(SimulationPurpose::kRangeChance),
                            StreamOfName(block_.name));
  for (int i = 0; i < hit.num_panes; ++i) {
    const PaneHit& pane = hit.panes[static_cast<std::size_t>(i)];
    if (pane.range_m >= hit.range_m) break;
    if (chance.Uniform(8 * beam + 1 + static_cast<std::uint64_t>(i)) < pane.response) return pane.range_m;
  }
  return hit.range_m;
}

std::vector<float> SimulatedLidar::Ranges(std::int64_t scan) const {
  const LidarSpec& lidar = scenario_.lidar;
  const std::uint32_t stream = StreamOfName(block_.name);
  const RandomStream noise(scenario_.seed, static_cast<std::uint32_t>(SimulationPurpose::kRangeNoise), stream);
  const RandomStream chance(scenario_.seed, static_cast<std::uint32_t>(SimulationPurpose::kRangeChance), stream);
  const std::size_t num_beams = beam_directions_.size();
  const double start = Seconds(StampOf(scan));
  const double duration = lidar.time_increment_s * static_cast<double>(num_beams);
  const Sweep sweep(trajectory_, start, duration);
  const std::vector<Walker> walkers = WalkersAt(start, sweep.at_start.head<2>());

  // The tilt shortens a beam's way in the plane; it hardly changes within a sweep.
  const double yaw_offset = trajectory_.body_from_lidar().theta;
  const Eigen::Matrix3d level_from_lidar = Eigen::AngleAxisd(-sweep.At(0.5).z(), Eigen::Vector3d::UnitZ()) *
                                           trajectory_.At(start + duration / 2).PlanFromBody() *
                                           Eigen::AngleAxisd(yaw_offset, Eigen::Vector3d::UnitZ());
  const Eigen::Matrix2d level = level_from_lidar.topLeftCorner<2, 2>();

  std::vector<float> ranges(num_beams);
  std::pair<double, double> normals;
  for (std::size_t i = 0; i < num_beams; ++i) {
    const std::uint64_t beam = static_cast<std::uint64_t>(scan) * num_beams + i;
    const Eigen::Vector3d pose = sweep.At(static_cast<double>(i) / static_cast<double>(num_beams));
    const Vector2d in_level = level * beam_directions_[i];
    const double shortening = in_level.norm();
    const double c = std::cos(pose.z());
    const double s = std::sin(pose.z());
    const Vector2d direction =
        Vector2d(c * in_level.x() - s * in_level.y(), s * in_level.x() + c * in_level.y()) / shortening;
    double range = Range(pose.head<2>(), direction, lidar.time_increment_s * static_cast<double>(i), walkers, beam);
    range /= shortening;

    if (i % 2 == 0) normals = noise.Normals((static_cast<std::uint64_t>(scan) * (num_beams + 1) + i) / 2);
    if (std::isfinite(range)) {
      range += (i % 2 == 0 ? normals.first : normals.second) *
               (range <= lidar.near_limit_m ? lidar.near_sigma_m : lidar.far_sigma_m);
      if (range > lidar.range_max_m) range = kNoReturn;
      if (range < lidar.range_min_m || chance.Uniform(8 * beam) < lidar.dropout_probability) range = kInvalidRange;
    }
    ranges[i] = static_cast<float>(std::round(range * 1000.0) / 1000.0);  // the instrument reads millimetres
  }
  return ranges;
}

}  // namespace survey
