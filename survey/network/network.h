// SPDX-License-Identifier: Apache-2.0
//
// A survey network: points and the observations between them, as the adjustment takes them.
// Plane networks: x east, y north, z height (m), right-handed. Geocentric networks: x, y, z of the Earth-centred frame;
// levelled instruments then stand on the ellipsoid's normal of their station.
// Directions, angles and azimuths count clockwise seen from above, azimuths from north; radians, metres.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace survey {

// What the adjustment does with a point's plane coordinates or with its height. kConstrained coordinates are adjusted
// and define the datum of a free network together (inner constraints).
enum class CoordinateUse { kUnused, kFixed, kAdjusted, kConstrained };

struct NetworkPoint {
  std::string name;
  CoordinateUse plane = CoordinateUse::kUnused;
  CoordinateUse height = CoordinateUse::kUnused;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // given, or approximate
  bool plane_known = false;                            // else approximate coordinates are computed
  bool height_known = false;

  CoordinateUse Use(int component) const { return component < 2 ? plane : height; }
  bool IsUnknown(int component) const { return Use(component) >= CoordinateUse::kAdjusted; }
};

enum class ObservationKind {
  kDirection,         // in a set with one orientation unknown
  kAngle,             // from the backsight `to` to the foresight `fore`
  kAzimuth,           // from north
  kDistance,          // horizontal
  kSlopeDistance,     // between instrument and target
  kZenithAngle,       // between instrument and target
  kHeightDifference,  // levelled: height of `to` minus height of `from`
  kHeight,            // of `from`, above the ellipsoid in geocentric networks
  kCoordinate,        // one component of `from`
  kDifference,        // one component of `to` minus that of `from`
};

constexpr std::string_view Name(ObservationKind kind) {
  constexpr std::string_view kNames[] = {"direction",         "angle",
                                         "azimuth",           "distance",
                                         "slope distance",    "zenith angle",
                                         "height difference", "height",
                                         "coordinate",        "coordinate difference"};
  return kNames[static_cast<int>(kind)];
}

constexpr bool IsAngular(ObservationKind kind) {
  return kind <= ObservationKind::kAzimuth || kind == ObservationKind::kZenithAngle;
}

struct Observation {
  ObservationKind kind = ObservationKind::kDistance;
  int from = -1;                 // index of the point
  int to = -1;                   // -1: none
  int fore = -1;                 // foresight of an angle
  int set = -1;                  // of a direction
  int component = 0;             // of a coordinate or a difference: 0 x, 1 y, 2 z
  double value = 0.0;            // m or rad
  double sigma = 0.0;            // 1 sigma a priori, m or rad
  double instrument_height = 0;  // m, above `from`
  double target_height = 0;      // m, above `to`
  int line = 0;                  // in the file it came from, for messages
};

// Observations [first, first + covariance.rows()) that are correlated; covariance in m and rad.
struct CorrelatedObservations {
  std::size_t first = 0;
  Eigen::MatrixXd covariance;
};

struct NetworkGeometry {
  bool geocentric = false;
  // Of plane networks in a projected system whose distances were observed on the ground: grid = factor * ground.
  double combined_factor = 1.0;
};

struct Network {
  std::string description;
  std::vector<NetworkPoint> points;
  std::vector<Observation> observations;
  std::vector<CorrelatedObservations> correlated;  // in order of `first`, not overlapping
  int num_sets = 0;                                // of directions
  NetworkGeometry geometry;
  double sigma_zero = 1.0;             // a priori; the unit in which a posteriori values are also reported
  bool use_sigma_a_posteriori = true;  // scale the covariances by it
  double confidence = 0.95;            // of tests and regions
};

}  // namespace survey
