// SPDX-License-Identifier: Apache-2.0
//
// Least-squares rigid (3-parameter) and similarity (4-parameter) fits between two sets of plane points, closed form
// (centroids and the angle of the cross-covariance).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "survey/geometry/pose2.h"

namespace survey {

struct RigidFit {
  Pose2 target_from_source;
  double similarity_scale = 1.0;  // scale a four-parameter fit takes; not part of target_from_source
  double rms_m = 0.0;             // root mean square length of the residuals of the rigid fit
};

// Minimises sum w_i |target_i - target_from_source * source_i|^2. Weights may be empty (all one). Empty result with
// fewer than two points or when the points coincide (the rotation is not determined).
std::optional<RigidFit> FitRigid(std::span<const Eigen::Vector2d> source, std::span<const Eigen::Vector2d> target,
                                 std::span<const double> weights = {});

// The motion that leaves the median residual least, up to half of the pairs being wrong: least median of squares
// [Rousseeuw84] over all motions by two pairs, then FitRigid on the pairs within 2.5 robust sigmas (1.4826 times the
// median). Empty as above.
std::optional<RigidFit> FitRigidRobust(std::span<const Eigen::Vector2d> source,
                                       std::span<const Eigen::Vector2d> target);

// Three pairs or more whose mirror image leaves less than a tenth of what they leave as they are (rms): a lidar upside
// down, or two axes exchanged.
bool FitsOnlyMirrored(std::span<const Eigen::Vector2d> source, std::span<const Eigen::Vector2d> target);

}  // namespace survey
