// SPDX-License-Identifier: Apache-2.0
//
// The control points of a block as observations of its graph, [CN] eq. (11): their coordinates with the covariances
// that the network's adjustment left between them.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/graph/pose_graph.h"

namespace survey {

struct GivenControl {
  std::vector<GivenCoordinates> given;  // points that are correlated together, each group in order of names
  std::string problem;                  // why not usable; empty when all is well
};

// Control points among `point_names` (the graph's, ascending) but `left_out`, minus `offset`. A free network's
// covariance is singular: where it is, each coordinate gets 0.03 mm of its own.
GivenControl GiveControl(const ControlNetwork& control, const std::vector<std::string>& point_names,
                         const std::set<std::string>& left_out, const Eigen::Vector2d& offset);

}  // namespace survey
