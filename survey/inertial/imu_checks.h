// SPDX-License-Identifier: Apache-2.0
//
// What a recorded IMU must hold before anything is integrated: units, axes, samples that are no measurements. Pure:
// messages for the caller to put file and row before.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "survey/sensors/session.h"

namespace survey {

// A stretch of samples that are no measurements, and why.
struct UnusableImu {
  enum class Cause { kLostPackets, kStuck, kSaturated };
  Cause cause = Cause::kLostPackets;
  std::string axis;  // of a saturation: "gyro z"
  double value = 0.0;
  std::size_t begin = 0;  // samples [begin, end)
  std::size_t end = 0;
};

// Samples that read zero on all axes (a lost packet: gravity never vanishes), that repeat all six values for a tenth of
// a second or more, or that clip: three or more in a row at the largest value of the log, beyond what a slow cart
// reaches. In order of their begin.
std::vector<UnusableImu> FindUnusable(std::span<const ImuSample> imu);

// The samples that are left.
std::vector<ImuSample> UsableImu(std::span<const ImuSample> imu);

// Why the whole record cannot be what its header says; empty when nothing is wrong. The specific force at rest tells
// units (g for m/s2), missing gravity and exchanged or turned axes; the angular rates tell degrees by their size, and
// against odometry (where there is enough turning) also the sense of rotation.
struct ImuFault {
  std::size_t index = 0;  // a sample that shows it
  std::string message;
};
std::optional<ImuFault> FindImuFault(std::span<const ImuSample> imu, std::span<const OdometrySample> odometry);

// What a person should know: what FindUnusable left out, gaps of more than half a second, a mounting that is far from
// level.
std::vector<std::string> ImuWarnings(std::span<const ImuSample> imu);

}  // namespace survey
