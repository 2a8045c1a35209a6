// SPDX-License-Identifier: Apache-2.0
//
// Coordinate geometry points of LandXML: <CgPoint name="...">northing easting elevation</CgPoint>, in the unit that
// <Units> states. Nothing is said there of sigmas or roles.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace formats {

struct LandXmlPoint {
  std::string name;
  Eigen::Vector2d east_north = Eigen::Vector2d::Zero();  // m
  std::optional<double> elevation_m;
  std::string description;
};

struct LandXmlFile {
  std::vector<LandXmlPoint> points;  // in order of their names
  std::string epsg_code;             // of <CoordinateSystem>, empty when it names none
  std::vector<std::string> warnings;
};

// DataError names file, line, value and rule.
LandXmlFile ReadLandXml(const std::filesystem::path& file);

}  // namespace formats
