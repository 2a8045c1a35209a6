// SPDX-License-Identifier: Apache-2.0
//
// delivered/control.csv and delivered/poses.csv: what a delivery rested on, as `plumbline deliver` notes it, so that
// later certificates can tell what changed. Specified in README.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/accuracy/delivery.h"
#include "survey/graph/solution.h"
#include "survey/submaps/track.h"

namespace formats {

// DataError names file, row, value and rule.
std::vector<survey::DeliveredPoint> ReadDeliveredControl(const std::filesystem::path& file);
std::vector<survey::DeliveredPose> ReadDeliveredPoses(const std::filesystem::path& file);

void WriteDeliveredControl(const std::filesystem::path& file, const std::vector<survey::DeliveredPoint>& points);
void WriteDeliveredPoses(const std::filesystem::path& file, const std::vector<survey::DeliveredPose>& poses);

// Points that have coordinates.
std::vector<survey::DeliveredPoint> PointsOfDelivery(const survey::ControlNetwork& network);

// One pose per `spacing_m` of path (0: every scan); none of a block that is not tied.
std::vector<survey::DeliveredPose> PosesOfDelivery(const std::string& block, const survey::Solution& solution,
                                                   const std::vector<survey::ScanStamp>& stamps, double spacing_m);

}  // namespace formats
