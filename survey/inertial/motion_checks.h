// SPDX-License-Identifier: Apache-2.0
//
// What the motion sensors of a session say of each other, beyond the form of the data: units and axes of the IMU, the
// sense in which scans, gyro and odometry turn.
#pragma once

#include <string>
#include <vector>

#include "survey/sensors/session_checks.h"

namespace survey {

// The session must be sound (CheckSession). Empty when nothing contradicts.
std::vector<SessionFault> CheckMotionSensors(const Session& session);

// What a person should know of the IMU; see ImuWarnings.
std::vector<std::string> MotionWarnings(const Session& session);

}  // namespace survey
