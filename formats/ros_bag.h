// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 bags: sensor_msgs/LaserScan or MultiEchoLaserScan (its first echo), sensor_msgs/Imu and nav_msgs/Odometry.
// Stamps are those of the message headers. Transforms (tf) are not read: the mounting is an option of the stage, and
// the IMU's axes are taken for the body's.
#pragma once

#include <filesystem>

#include "formats/field_data.h"

namespace formats {

// Any kind may be missing. DataError: not a readable bag, several topics of one kind and no choice, values that are not
// finite.
FieldData ReadRosBag(const std::filesystem::path& file, const FieldDataOptions& options);

}  // namespace formats
