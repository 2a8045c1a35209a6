// SPDX-License-Identifier: Apache-2.0
#include "survey/geometry/pose2.h"

namespace survey {

Eigen::Matrix3d RotatedCovariance(const Eigen::Matrix3d& covariance, double angle_rad) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Rotation2(angle_rad);
  return rotation * covariance * rotation.transpose();
}

}  // namespace survey
