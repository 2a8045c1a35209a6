// SPDX-License-Identifier: Apache-2.0
//
// Levelling by gravity while the platform is quiet: roll, pitch and the gyros' biases. Heading is not sought: a MEMS
// gyro does not feel the Earth turn, and the first scan defines the block's axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "survey/inertial/imu_increment.h"

namespace survey {

// What counts as quiet. Standing still is quiet; so is driving evenly straight ahead, which levels as well. Even
// acceleration looks quiet, too, and tilts the level by a / g (0.5 m/s2: 0.05 rad): only other sensors tell.
struct QuietOptions {
  double window_s = 0.5;
  double max_rate_sigma_rad_s = 0.03;  // scatter of each axis within a window
  double max_force_sigma_m_s2 = 0.10;  // (an Xsens MTi-G at rest: 0.012 rad/s, 0.03 m/s2)
  double max_mean_rate_rad_s = 0.06;   // turning, unless it is a bias
  double max_change_rad_s = 0.01;      // of the mean from window to window
  double max_change_m_s2 = 0.05;
};

// Samples [begin, end) of an IMU.
struct SampleRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// The stretches during which the platform is quiet, at least two windows long each, in order.
std::vector<SampleRange> FindQuiet(std::span<const ImuSample> imu, const QuietOptions& options);

struct Levelling {
  Eigen::Quaterniond level_from_body = Eigen::Quaterniond::Identity();  // z up, the body's x ahead: heading zero
  Eigen::Vector3d mean_rate_in_body = Eigen::Vector3d::Zero();          // rad/s: the biases when at rest
  Eigen::Vector3d mean_force_in_body = Eigen::Vector3d::Zero();         // m/s2: its length is gravity plus bias
  Eigen::Vector3d rate_sigma = Eigen::Vector3d::Zero();                 // scatter of single samples
  Eigen::Vector3d force_sigma = Eigen::Vector3d::Zero();
  double seconds = 0.0;
};

// Means over the samples; empty with fewer than two, or without any force to level by.
std::optional<Levelling> Level(std::span<const ImuSample> samples);

// Attitude that brings a specific force at rest upright, by the shortest turn that keeps the body's x axis ahead.
Eigen::Quaterniond LevelFromBody(const Eigen::Vector3d& force_in_body);

}  // namespace survey
