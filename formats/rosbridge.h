// SPDX-License-Identifier: Apache-2.0
//
// Maps as messages of the rosbridge protocol (version 2), a JSON object a line: what an AR client of [AS] reads, and
// sends back when a person has edited the map or set the robot's pose. Occupancy grids: row 0 in the south; -1 unknown,
// 0 free, 100 occupied by the thresholds of map.yaml.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "survey/edits/map_edit.h"
#include "survey/geometry/pose2.h"
#include "survey/grid/raster_strips.h"

namespace formats {

enum class RosVersion { kRos1, kRos2 };

struct RosTopic {
  std::string name;  // "/map"
  survey::RasterStrips grid;
};

// An advertise and a publish for each topic. Stamps are zero; the origin is in site coordinates.
void WriteRosbridge(const std::filesystem::path& file, const std::vector<RosTopic>& topics, RosVersion version);

struct RosGrid {
  survey::SiteRaster frame;        // without cells
  std::vector<std::int8_t> cells;  // row by row from the south
};

// A PoseWithCovarianceStamped on /initialpose: where a person put the robot.
struct RosPose {
  survey::StampNs stamp_ns = 0;  // of the scan that it is about
  survey::Pose2 site_from_robot;
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  // m, m, rad
};

// What a client sent: the last grid that it published on /map, and all poses.
struct RosbridgeReply {
  std::optional<RosGrid> map;
  std::vector<RosPose> poses;
};

// DataError names file and line: no JSON, a grid that is not whole, a pose without covariance; neither grid nor pose.
RosbridgeReply ReadRosbridge(const std::filesystem::path& file);

// What a person changed in the grid that was exported: edits of kCells, one for each state that cells were set to.
// DataError when it is not a grid of the same place, size and cells.
std::vector<survey::MapEdit> CellEdits(const RosGrid& edited, const survey::RasterStrips& exported,
                                       const std::string& where);

}  // namespace formats
