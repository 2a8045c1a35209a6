// SPDX-License-Identifier: Apache-2.0
//
// Public pose graphs in the text format of g2o (EDGE_SE2), packed by gzip.
#pragma once

#include <filesystem>

#include "survey/graph/pose_graph.h"

namespace test_support {

// Poses start from the edges chained one after the other, as odometry does; the first is held. g2o weighs the
// translation of an edge in axes of the measured pose, [CN] eq. (10) in those of the base: the covariances are turned
// accordingly, so that the sum of squares is the same. Throws std::runtime_error.
survey::PoseGraph ReadG2o(const std::filesystem::path& file);

}  // namespace test_support
