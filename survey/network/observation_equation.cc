// SPDX-License-Identifier: Apache-2.0
#include "survey/network/observation_equation.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <cmath>

namespace survey {
namespace {

using Row = Eigen::RowVector3d;

const GeographicLib::Geocentric& Earth() { return GeographicLib::NormalGravity::GRS80().Earth(); }

// From instrument to target in the levelled frame of the instrument's station, and that frame.
struct Sight {
  Eigen::Matrix3d axes;
  Eigen::Vector3d d;
  double horizontal = 0.0;  // length of d's horizontal part

  Row AzimuthPartial() const { return (d.y() * axes.row(0) - d.x() * axes.row(1)) / (horizontal * horizontal); }
  Row DistancePartial() const { return (d.x() * axes.row(0) + d.y() * axes.row(1)) / horizontal; }
  Row SlopePartial() const { return d.transpose() * axes / d.norm(); }
  Row ZenithPartial() const { return (d.z() * DistancePartial() - horizontal * axes.row(2)) / d.squaredNorm(); }
};

// From coordinates to metres on the ground in the levelled frame.
Eigen::Matrix3d AxesAt(const Eigen::Vector3d& position, const NetworkGeometry& geometry) {
  if (geometry.geocentric) return LevelledAxes(position);
  const double scale = 1.0 / geometry.combined_factor;
  return Eigen::Vector3d(scale, scale, 1.0).asDiagonal();
}

Sight SightTo(const Observation& observation, int target, const std::vector<Eigen::Vector3d>& positions,
              const NetworkGeometry& geometry) {
  const Eigen::Vector3d& from = positions[static_cast<std::size_t>(observation.from)];
  const Eigen::Vector3d& to = positions[static_cast<std::size_t>(target)];
  Sight sight{.axes = AxesAt(from, geometry)};
  const Eigen::Vector3d up_at_target = AxesAt(to, geometry).row(2).transpose();
  sight.d = sight.axes * (to - from + observation.target_height * up_at_target);
  sight.d.z() -= observation.instrument_height;
  sight.horizontal = std::hypot(sight.d.x(), sight.d.y());
  return sight;
}

// All that depends on the difference of two points has opposite derivatives at them.
void SetBetween(const Observation& observation, const Row& partial_at_target, ObservationEquation* equation) {
  equation->num_points = 2;
  equation->points = {observation.from, observation.to, -1};
  equation->partials[0] = -partial_at_target;
  equation->partials[1] = partial_at_target;
}

void EvaluateAngle(const Observation& observation, const std::vector<Eigen::Vector3d>& positions,
                   const NetworkGeometry& geometry, ObservationEquation* equation) {
  const Sight back = SightTo(observation, observation.to, positions, geometry);
  const Sight fore = SightTo(observation, observation.fore, positions, geometry);
  equation->computed = std::atan2(fore.d.x(), fore.d.y()) - std::atan2(back.d.x(), back.d.y());
  equation->num_points = 3;
  equation->points = {observation.from, observation.to, observation.fore};
  equation->partials = {back.AzimuthPartial() - fore.AzimuthPartial(), -back.AzimuthPartial(), fore.AzimuthPartial()};
}

void EvaluateHeights(const Observation& observation, const std::vector<Eigen::Vector3d>& positions,
                     const NetworkGeometry& geometry, ObservationEquation* equation) {
  const auto height = [&](int point) {
    const Eigen::Vector3d& p = positions[static_cast<std::size_t>(point)];
    return geometry.geocentric ? EllipsoidalHeight(p) : p.z();
  };
  const auto up = [&](int point) -> Row { return AxesAt(positions[static_cast<std::size_t>(point)], geometry).row(2); };
  equation->num_points = 1;
  equation->points = {observation.from, observation.to, -1};
  equation->computed = height(observation.from);
  equation->partials[0] = up(observation.from);
  if (observation.kind == ObservationKind::kHeight) return;
  equation->num_points = 2;
  equation->computed = height(observation.to) - height(observation.from);
  equation->partials[0] = -up(observation.from);
  equation->partials[1] = up(observation.to);
}

void EvaluateComponent(const Observation& observation, const std::vector<Eigen::Vector3d>& positions,
                       const NetworkGeometry& geometry, ObservationEquation* equation) {
  const bool on_ground = observation.kind == ObservationKind::kDifference && observation.component < 2;
  const double scale = on_ground ? 1.0 / geometry.combined_factor : 1.0;
  const Row unit = scale * Row::Unit(observation.component);
  const double from = positions[static_cast<std::size_t>(observation.from)][observation.component];
  if (observation.kind == ObservationKind::kCoordinate) {
    equation->num_points = 1;
    equation->points[0] = observation.from;
    equation->partials[0] = unit;
    equation->computed = from;
    return;
  }
  SetBetween(observation, unit, equation);
  equation->computed = scale * (positions[static_cast<std::size_t>(observation.to)][observation.component] - from);
}

void EvaluateSight(const Observation& observation, const std::vector<Eigen::Vector3d>& positions, double orientation,
                   const NetworkGeometry& geometry, ObservationEquation* equation) {
  const Sight sight = SightTo(observation, observation.to, positions, geometry);
  switch (observation.kind) {
    case ObservationKind::kDistance:
      equation->computed = sight.horizontal;
      return SetBetween(observation, sight.DistancePartial(), equation);
    case ObservationKind::kSlopeDistance:
      equation->computed = sight.d.norm();
      return SetBetween(observation, sight.SlopePartial(), equation);
    case ObservationKind::kZenithAngle:
      equation->computed = std::atan2(sight.horizontal, sight.d.z());
      return SetBetween(observation, sight.ZenithPartial(), equation);
    default:  // azimuth or direction
      equation->computed = std::atan2(sight.d.x(), sight.d.y());
      SetBetween(observation, sight.AzimuthPartial(), equation);
      if (observation.kind == ObservationKind::kDirection) {
        equation->computed -= orientation;
        equation->orientation_partial = -1.0;
      }
  }
}

}  // namespace

Eigen::Matrix3d LevelledAxes(const Eigen::Vector3d& position) {
  double latitude = 0.0, longitude = 0.0, height = 0.0;
  std::vector<double> from_local(9);
  Earth().Reverse(position.x(), position.y(), position.z(), latitude, longitude, height, from_local);
  return Eigen::Map<const Eigen::Matrix3d>(from_local.data());  // column-major: the transpose of the row-major one
}

double EllipsoidalHeight(const Eigen::Vector3d& geocentric_position) {
  double latitude = 0.0, longitude = 0.0, height = 0.0;
  Earth().Reverse(geocentric_position.x(), geocentric_position.y(), geocentric_position.z(), latitude, longitude,
                  height);
  return height;
}

double WrappedAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * M_PI);
  return wrapped <= -M_PI ? M_PI : wrapped;
}

double Misclosure(const Observation& observation, double computed) {
  const double difference = observation.value - computed;
  return IsAngular(observation.kind) ? WrappedAngle(difference) : difference;
}

ObservationEquation Evaluate(const Observation& observation, const std::vector<Eigen::Vector3d>& positions,
                             double orientation, const NetworkGeometry& geometry) {
  ObservationEquation equation;
  switch (observation.kind) {
    case ObservationKind::kAngle:
      EvaluateAngle(observation, positions, geometry, &equation);
      break;
    case ObservationKind::kHeightDifference:
    case ObservationKind::kHeight:
      EvaluateHeights(observation, positions, geometry, &equation);
      break;
    case ObservationKind::kCoordinate:
    case ObservationKind::kDifference:
      EvaluateComponent(observation, positions, geometry, &equation);
      break;
    default:
      EvaluateSight(observation, positions, orientation, geometry, &equation);
  }
  return equation;
}

}  // namespace survey
