// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/reference_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d DirectionOf(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

class Station {
 public:
  Station(const Scenario& scenario, const RayCaster& building, std::uint32_t number)
      : spec_(scenario.reference),
        building_(building),
        noise_(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kReference), number) {
    const Vector2d place = spec_.stations[number];
    origin_ = {place.x(), place.y(), spec_.scanner_height_m};
  }

  // Corners need dense lines, not dense faces.
  void ScanBuilding(std::vector<Eigen::Vector3f>* cloud) {
    const auto columns = static_cast<int>(std::round(2.0 * std::numbers::pi / spec_.step_rad));
    std::vector<double> level_ranges;
    for (int column = 0; column < columns; ++column) level_ranges.push_back(LevelRange(column * spec_.step_rad));
    for (int row = -kRows; row <= kRows; ++row) {
      for (int column = 0; column < columns; ++column)
        Measure(DirectionOf(column * spec_.step_rad, row * kRowStep_rad),
                level_ranges[static_cast<std::size_t>(column)], cloud);
    }
  }

  void ScanTarget(const Vector3d& centre, std::vector<Eigen::Vector3f>* cloud) {
    const Vector3d to_centre = centre - origin_;
    const double distance = to_centre.norm();
    if (distance > kTargetReach || distance < 1.0) return;
    const double half = 1.5 * spec_.sphere_radius_m / distance;
    const auto steps = static_cast<int>(std::ceil(half / spec_.target_step_rad));
    const double azimuth = std::atan2(to_centre.y(), to_centre.x());
    const double elevation = std::asin(to_centre.z() / distance);
    for (int row = -steps; row <= steps; ++row) {
      for (int column = -steps; column <= steps; ++column) {
        const double turn = azimuth + column * spec_.target_step_rad;
        Measure(DirectionOf(turn, elevation + row * spec_.target_step_rad), LevelRange(turn), cloud);
      }
    }
  }

 private:
  static constexpr double kTargetReach = 15.0;
  static constexpr double kRowStep_rad = 0.035;
  static constexpr int kRows = 28;  // to 56 degrees above and below

  // `level_range`: to the building in the plan.
  void Measure(const Vector3d& direction, double level_range, std::vector<Eigen::Vector3f>* cloud) {
    const std::uint64_t index = index_++;
    const double to_building = level_range / direction.head<2>().norm();
    double range = std::min({RangeToSpheres(direction), to_building, RangeToSlabs(direction)});
    if (range > spec_.range_max_m) return;
    range += spec_.noise_m * noise_.Normal(index);
    const Vector3d p_in_plan = origin_ + range * direction;
    const Vector2d planar = spec_.scanner_from_plan * Vector2d(p_in_plan.head<2>());
    cloud->emplace_back(static_cast<float>(planar.x()), static_cast<float>(planar.y()),
                        static_cast<float>(p_in_plan.z() + spec_.scanner_from_plan_z_m));
  }

  // Walls, pillars and cars taken as upright; the scanner looks through glass.
  double LevelRange(double azimuth) const {
    return building_.Cast(origin_.head<2>(), {std::cos(azimuth), std::sin(azimuth)}, spec_.range_max_m).range_m;
  }

  double RangeToSlabs(const Vector3d& direction) const {
    if (direction.z() == 0.0) return kNever;
    return direction.z() < 0 ? -origin_.z() / direction.z() : (spec_.ceiling_m - origin_.z()) / direction.z();
  }

  double RangeToSpheres(const Vector3d& direction) const {
    double nearest = kNever;
    for (const SphereTarget& target : spec_.targets) {
      const Vector3d to_centre = target.centre - origin_;
      const double along = to_centre.dot(direction);
      const double inside2 = spec_.sphere_radius_m * spec_.sphere_radius_m - (to_centre.squaredNorm() - along * along);
      if (along > 0 && inside2 >= 0) nearest = std::min(nearest, along - std::sqrt(inside2));
    }
    return nearest;
  }

  const ReferenceSpec& spec_;
  const RayCaster& building_;
  RandomStream noise_;
  Vector3d origin_;
  std::uint64_t index_ = 0;
};

}  // namespace

std::vector<Eigen::Vector3f> SimulateReferenceCloud(const Scenario& scenario, const RayCaster& building) {
  std::vector<Eigen::Vector3f> cloud;
  for (std::size_t i = 0; i < scenario.reference.stations.size(); ++i) {
    Station station(scenario, building, static_cast<std::uint32_t>(i));
    station.ScanBuilding(&cloud);
    for (const SphereTarget& target : scenario.reference.targets) station.ScanTarget(target.centre, &cloud);
  }
  return cloud;
}

std::vector<SurveyedTarget> SurveyTargets(const Scenario& scenario) {
  std::vector<SurveyedTarget> targets;
  for (const SphereTarget& target : scenario.reference.targets) {
    const RandomStream random(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kTargetSurvey),
                              StreamOfName(target.name));
    const auto [east, north] = random.Normals(0);
    const Vector2d planar = scenario.SiteOf(target.centre.head<2>());
    const Vector3d truth(planar.x(), planar.y(), scenario.elevation_m + target.centre.z());
    const Vector3d surveyed = truth + scenario.control_sigma_m * Vector3d(east, north, random.Normal(1));
    targets.push_back({target.name, (surveyed * 1e4).array().round().matrix() / 1e4});
  }
  return targets;
}

}  // namespace survey
