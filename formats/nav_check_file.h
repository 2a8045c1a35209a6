// SPDX-License-Identifier: Apache-2.0
//
// What `plumbline navcheck` found: which goals a robot reaches, before and after people edited the map. README.md, "Map
// edits".
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/provenance.h"

namespace formats {

// goals.csv: name,easting,northing; the first row is where the robot starts.
struct NavGoal {
  std::string name;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // site frame, m
};
std::vector<NavGoal> ReadNavGoals(const std::filesystem::path& file);

// One goal on one map.
struct NavResult {
  double clearance_m = 0.0;           // of the goal from walls, unknown cells and forbidden areas
  std::vector<Eigen::Vector2d> path;  // from the start; empty: there is none
};

struct NavCheck {
  NavGoal goal;
  NavResult before;  // the maps as scanned
  NavResult after;   // as edited, forbidden areas kept out of
};

// JSON with all numbers; the same as GeoJSON with the paths as lines, for QGIS.
void WriteNavChecks(const std::filesystem::path& file, const NavGoal& start, const std::vector<NavCheck>& checks,
                    const Provenance& provenance);
void WriteNavLayer(const std::filesystem::path& file, const std::vector<NavCheck>& checks, const std::string& crs);

}  // namespace formats
