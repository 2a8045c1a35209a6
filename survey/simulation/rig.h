// SPDX-License-Identifier: Apache-2.0
//
// The sensors on the cart: what they read on an exact motion. Stamps are those of the log's clock.
#pragma once

#include <cstdint>
#include <vector>

#include "survey/sensors/session.h"
#include "survey/simulation/ray_caster.h"
#include "survey/simulation/scenario.h"
#include "survey/simulation/trajectory.h"

namespace survey {

ScanGeometry GeometryOf(const LidarSpec& lidar);

// The LiDAR of a block: scan k is a function of k alone, so scans may be made in any order and thread.
class SimulatedLidar {
 public:
  SimulatedLidar(const Scenario& scenario, const BlockRoute& block, const RayCaster& building,
                 const Trajectory& trajectory);

  std::int64_t num_scans() const { return num_scans_; }
  StampNs StampOf(std::int64_t scan) const;

  // Ranges of a scan: kNoReturn where nothing is in reach, kInvalidRange where the echo was lost or too near.
  std::vector<float> Ranges(std::int64_t scan) const;

 private:
  struct Sweep;
  struct Walker {
    Disc disc;
    Eigen::Vector2d velocity;
  };
  std::vector<Walker> WalkersAt(double time_s, const Eigen::Vector2d& near) const;
  double Range(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double after_s,
               const std::vector<Walker>& walkers, std::uint64_t beam) const;

  const Scenario& scenario_;
  const BlockRoute& block_;
  const RayCaster& building_;
  const Trajectory& trajectory_;
  std::int64_t num_scans_ = 0;
  std::vector<Eigen::Vector2d> beam_directions_;  // in the lidar frame
};

// Angular rate and specific force of the body at the IMU's rate: exact motion, the Earth's rotation and gravity,
// turn-on biases and white noise.
std::vector<ImuSample> SimulateImu(const Scenario& scenario, const BlockRoute& block, const Trajectory& trajectory);

// Wheel odometry that starts at zero: scale error, drift, noise and slips.
std::vector<OdometrySample> SimulateOdometry(const Scenario& scenario, const BlockRoute& block,
                                             const Trajectory& trajectory);

// Where somebody who walks to and fro is after a time, and the velocity.
struct WalkState {
  Eigen::Vector2d position;
  Eigen::Vector2d velocity;
};
WalkState WalkAt(const Person& person, double phase_m, double time_s);

}  // namespace survey
