// SPDX-License-Identifier: Apache-2.0
//
// What `simulate` writes beside the blocks' field data (examples/parking-garage/README.md lists the files): the
// surveyors' lists, the terrestrial scanner's cloud and the exact truth. Site frame; x east, y north.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/sensors/session.h"
#include "survey/simulation/reference_scan.h"
#include "survey/simulation/survey_work.h"

namespace formats {

// point,northing,easting,elevation,sigma_n,sigma_e,description,role
void WriteControlCsv(const std::filesystem::path& file, const std::vector<survey::ControlPoint>& points);

// name,northing,easting,sigma_n,sigma_e,kind
void WriteFeaturesCsv(const std::filesystem::path& file, const std::vector<survey::SurveyedFeature>& features,
                      double sigma_m);

// name,northing,easting: exact places of points and features.
struct TruePlace {
  std::string name;
  Eigen::Vector2d position_in_site;
};
void WriteTruePlacesCsv(const std::filesystem::path& file, const std::vector<TruePlace>& places);

// Trajectory as lines t x y z qx qy qz qw.
struct TimedPose {
  survey::StampNs stamp_ns;
  Eigen::Isometry3d site_from_lidar;
};
void WriteTum(const std::filesystem::path& file, const std::vector<TimedPose>& poses);

// target,northing,easting,elevation,sigma_m,radius_m
void WriteTargetsCsv(const std::filesystem::path& file, const std::vector<survey::SurveyedTarget>& targets,
                     double sigma_m, double radius_m);

// Binary little-endian PLY with float x, y, z (m).
void WritePly(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points);

}  // namespace formats
