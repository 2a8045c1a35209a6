// SPDX-License-Identifier: Apache-2.0
//
// What changed since a site was delivered: the control that moved, and by how much the map followed. Lengths in metres,
// site frame (east, north).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/sensors/session.h"

namespace survey {

struct DeliveredPoint {
  std::string name;
  PointRole role = PointRole::kControl;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

// Where the platform was at some scans of a tied block: the map was drawn from there.
struct DeliveredPose {
  std::string block;
  StampNs stamp_ns = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

// What a delivery rested on.
struct Delivery {
  std::vector<DeliveredPoint> points;
  std::vector<DeliveredPose> poses;
};

enum class PointFate { kMoved, kAdded, kRemoved, kOtherRole };

// One point that is not as it was. `map_shift` is that of the nearest pose within kNearPointM, the largest of all
// blocks; empty when no block was there.
struct ControlChange {
  std::string name;
  PointFate fate = PointFate::kMoved;
  std::optional<DeliveredPoint> before;
  std::optional<DeliveredPoint> now;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // now - before; zero when it is in one of them only
  std::optional<Eigen::Vector2d> map_shift;
};

// How far the map of one block moved: over the poses that both know.
struct BlockChange {
  std::string name;
  int num_poses = 0;  // compared; 0: a new block, one that is gone, or one that was recorded anew
  Eigen::Vector2d mean_shift = Eigen::Vector2d::Zero();
  double rms_shift = 0.0;
  double max_shift = 0.0;
  Eigen::Vector2d place_of_max = Eigen::Vector2d::Zero();  // as it is now
};

struct DeliveryChanges {
  std::vector<ControlChange> control;  // in order of their names; coordinates count as moved from kMovedM on
  std::vector<BlockChange> blocks;     // in order of their names
};

constexpr double kMovedM = 1e-4;
constexpr double kNearPointM = 5.0;

// `now` holds every scan of the tied blocks or a part; poses are compared by block and stamp.
DeliveryChanges CompareDeliveries(const Delivery& before, const Delivery& now);

}  // namespace survey
