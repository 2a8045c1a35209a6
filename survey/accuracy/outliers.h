// SPDX-License-Identifier: Apache-2.0
//
// Errors that do not belong to the others: Rosner's generalised extreme studentised deviate [Rosner83] carried to two
// dimensions, with Mahalanobis distances and Wilks' critical values [Caroni92]. Needs no class; finds errors that are
// small against the class but strange against the rest.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace survey {

// Indices in order of their strangeness; up to a tenth of the errors and one, none among fewer than ten.
std::vector<int> FindErrorOutliers(std::span<const Eigen::Vector2d> errors, double significance = 0.05);

}  // namespace survey
