// SPDX-License-Identifier: Apache-2.0
//
// The control plan of a block: JSON for programs, a picture for people.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/provenance.h"

namespace formats {

struct PlanReport {
  struct Point {
    std::string name;
    bool existing = false;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  // site frame (local when not tied), m
    double rms = 0.0;                                 // of the path with this point and those before, m
    double max = 0.0;
  };
  struct Place {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double sigma = 0.0;  // with all points, m
  };
  struct Wall {
    Eigen::Vector2d a = Eigen::Vector2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
  };
  bool tied = false;
  std::string crs;
  std::vector<Point> points;
  std::vector<Place> path;
  std::vector<Wall> walls;  // of the floor plan, where there is one; for the picture
};

void WritePlan(const std::filesystem::path& file, const PlanReport& report, const Provenance& provenance);

// SVG: accuracy against the number of points, and the way coloured by it with the points, in its building.
void WritePlanPicture(const std::filesystem::path& file, const PlanReport& report);

}  // namespace formats
