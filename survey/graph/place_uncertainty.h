// SPDX-License-Identifier: Apache-2.0
//
// How uncertain the poses leave what is read at one place of a block's map, such as a corner: it is the mean of what
// many poses drew there, and surer than by the nearest one alone (map_uncertainty.h). The range noise is not in it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "survey/graph/solution.h"

namespace survey {

// Covariance, m2. The errors of poses are carried to the place by their headings and averaged, those near it weighing
// the most. A solution tells no covariance between two poses: their errors are taken as the more alike the nearer they
// stand to each other. Empty where the solution has no covariances.
std::optional<Eigen::Matrix2d> PlaceCovariance(const Eigen::Vector2d& place, const Solution& solution);

}  // namespace survey
