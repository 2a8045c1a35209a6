// SPDX-License-Identifier: Apache-2.0
//
// A block's scans with their final poses: what its map is drawn from.
#pragma once

#include <filesystem>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/graph/solution.h"
#include "survey/sensors/session.h"

namespace formats {

struct PosedSession {
  survey::Session session;
  survey::Solution solution;
  std::vector<survey::Pose2> site_from_scan;  // of every scan of the session
};

// DataError when the files do not belong together.
PosedSession ReadPosedSession(const std::filesystem::path& session_file, const std::filesystem::path& solution_file);

}  // namespace formats
