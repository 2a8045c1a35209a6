// SPDX-License-Identifier: Apache-2.0
//
// Named things whose places can be surveyed and found again in a map: corners of walls and pillars, pillar centres.
// Site frame (east, north), metres.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace survey {

// Faces of a corner meet at 30 to 150 degrees.
inline constexpr double kMinSineOfCorner = 0.5;

enum class FeatureKind { kCorner, kPillar };

constexpr std::string_view Name(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::kCorner:
      return "corner";
    case FeatureKind::kPillar:
      return "pillar";
  }
  return "";
}

// As surveyed: says where to look in a map, and is the reference when the map is tested.
struct NamedFeature {
  std::string name;
  FeatureKind kind = FeatureKind::kCorner;
  Eigen::Vector2d position_in_site = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

// As seen in one map. Position and covariances only where found.
struct MapFeature {
  std::string name;
  FeatureKind kind = FeatureKind::kCorner;
  bool found = false;
  std::string reason;  // why not found
  Eigen::Vector2d position_in_site = Eigen::Vector2d::Zero();
  Eigen::Matrix2d reading = Eigen::Matrix2d::Zero();     // covariance, were the poses that drew the map without error
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of the place: of the reading and of these poses
  int num_cells = 0;                                     // wall cells that took part
};

}  // namespace survey
