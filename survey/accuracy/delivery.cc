// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/delivery.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace survey {
namespace {

struct ComparedPose {
  Eigen::Vector2d before;
  Eigen::Vector2d now;
  Eigen::Vector2d Shift() const { return now - before; }
};

using PosesByBlock = std::map<std::string, std::vector<ComparedPose>>;

PosesByBlock Compared(const Delivery& before, const Delivery& now) {
  std::map<std::pair<std::string, StampNs>, Eigen::Vector2d> place_now;
  PosesByBlock compared;
  for (const DeliveredPose& pose : now.poses) {
    place_now[{pose.block, pose.stamp_ns}] = pose.position;
    compared[pose.block];
  }
  for (const DeliveredPose& pose : before.poses) {
    std::vector<ComparedPose>& poses = compared[pose.block];
    const auto found = place_now.find({pose.block, pose.stamp_ns});
    if (found != place_now.end()) poses.push_back({pose.position, found->second});
  }
  return compared;
}

BlockChange ChangeOf(const std::string& block, const std::vector<ComparedPose>& poses) {
  BlockChange change{.name = block, .num_poses = static_cast<int>(poses.size())};
  double squares = 0.0;
  for (const ComparedPose& pose : poses) {
    const double length = pose.Shift().norm();
    change.mean_shift += pose.Shift() / static_cast<double>(poses.size());
    squares += length * length;
    if (length < change.max_shift) continue;
    change.max_shift = length;
    change.place_of_max = pose.now;
  }
  if (!poses.empty()) change.rms_shift = std::sqrt(squares / static_cast<double>(poses.size()));
  return change;
}

// Of the nearest pose of one block.
std::optional<Eigen::Vector2d> ShiftNear(const Eigen::Vector2d& place, const std::vector<ComparedPose>& poses) {
  std::optional<Eigen::Vector2d> shift;
  double nearest = kNearPointM;
  for (const ComparedPose& pose : poses) {
    const double distance = (pose.before - place).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    shift = pose.Shift();
  }
  return shift;
}

std::optional<Eigen::Vector2d> LargestShiftNear(const Eigen::Vector2d& place, const PosesByBlock& blocks) {
  std::optional<Eigen::Vector2d> largest;
  for (const auto& [block, poses] : blocks) {
    const std::optional<Eigen::Vector2d> shift = ShiftNear(place, poses);
    if (shift && (!largest || shift->norm() > largest->norm())) largest = shift;
  }
  return largest;
}

// Nothing when the point is as it was.
std::optional<PointFate> FateOf(const std::optional<DeliveredPoint>& before, const std::optional<DeliveredPoint>& now) {
  if (!before) return PointFate::kAdded;
  if (!now) return PointFate::kRemoved;
  if ((now->position - before->position).norm() >= kMovedM) return PointFate::kMoved;
  if (now->role != before->role) return PointFate::kOtherRole;
  return std::nullopt;
}

std::vector<ControlChange> ControlChanges(const Delivery& before, const Delivery& now, const PosesByBlock& poses) {
  std::map<std::string, ControlChange> all;
  for (const DeliveredPoint& point : before.points) all[point.name].before = point;
  for (const DeliveredPoint& point : now.points) all[point.name].now = point;
  std::vector<ControlChange> changes;
  for (auto& [name, change] : all) {
    const std::optional<PointFate> fate = FateOf(change.before, change.now);
    if (!fate) continue;
    change.name = name;
    change.fate = *fate;
    if (change.before && change.now) change.shift = change.now->position - change.before->position;
    change.map_shift = LargestShiftNear((change.before ? change.before : change.now)->position, poses);
    changes.push_back(change);
  }
  return changes;
}

}  // namespace

DeliveryChanges CompareDeliveries(const Delivery& before, const Delivery& now) {
  const PosesByBlock poses = Compared(before, now);
  DeliveryChanges changes{.control = ControlChanges(before, now, poses), .blocks = {}};
  for (const auto& [block, compared] : poses) changes.blocks.push_back(ChangeOf(block, compared));
  return changes;
}

}  // namespace survey
