// SPDX-License-Identifier: Apache-2.0
#include "formats/simulated_site.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "formats/atomic_file.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

std::string Fixed(double value, int decimals) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
  return buffer;
}

// Northing first, as in the control list.
std::string NorthEast(const Eigen::Vector2d& p_in_site, int decimals) {
  return Fixed(p_in_site.y(), decimals) + "," + Fixed(p_in_site.x(), decimals);
}

}  // namespace

void WriteControlCsv(const fs::path& file, const std::vector<survey::ControlPoint>& points) {
  std::string text = "point,northing,easting,elevation,sigma_n,sigma_e,description,role\n";
  for (const survey::ControlPoint& point : points) {
    text += point.name + "," + NorthEast(point.position_in_site, 4) + "," + Fixed(point.elevation_m.value_or(0.0), 3) +
            "," + NumberText(std::sqrt(point.covariance(1, 1))) + "," + NumberText(std::sqrt(point.covariance(0, 0))) +
            "," + point.description + "," + std::string(survey::Name(point.role)) + "\n";
  }
  WriteFileAtomically(file, text);
}

void WriteFeaturesCsv(const fs::path& file, const std::vector<survey::SurveyedFeature>& features, double sigma_m) {
  std::string text = "name,northing,easting,sigma_n,sigma_e,kind\n";
  for (const survey::SurveyedFeature& one : features) {
    text += one.feature.name + "," + NorthEast(one.surveyed_in_site, 4) + "," + NumberText(sigma_m) + "," +
            NumberText(sigma_m) + "," + (one.feature.kind == survey::FeatureKind::kPillar ? "pillar" : "corner") + "\n";
  }
  WriteFileAtomically(file, text);
}

void WriteTruePlacesCsv(const fs::path& file, const std::vector<TruePlace>& places) {
  std::string text = "name,northing,easting\n";
  for (const TruePlace& place : places) text += place.name + "," + NorthEast(place.position_in_site, 6) + "\n";
  WriteFileAtomically(file, text);
}

void WriteTum(const fs::path& file, const std::vector<TimedPose>& poses) {
  std::string text;
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d p = pose.site_from_lidar.translation();
    const Eigen::Quaterniond q(pose.site_from_lidar.linear());
    const double sign = q.w() < 0 ? -1.0 : 1.0;
    text += StampText(pose.stamp_ns);
    for (const double value : {p.x(), p.y(), p.z()}) text += " " + Fixed(value, 6);
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) text += " " + Fixed(sign * value, 9);
    text += "\n";
  }
  WriteFileAtomically(file, text);
}

void WriteTargetsCsv(const fs::path& file, const std::vector<survey::SurveyedTarget>& targets, double sigma_m,
                     double radius_m) {
  std::string text = "target,northing,easting,elevation,sigma_m,radius_m\n";
  for (const survey::SurveyedTarget& target : targets) {
    text += target.name + "," + NorthEast(target.centre_in_site.head<2>(), 4) + "," +
            Fixed(target.centre_in_site.z(), 4) + "," + NumberText(sigma_m) + "," + NumberText(radius_m) + "\n";
  }
  WriteFileAtomically(file, text);
}

void WritePly(const fs::path& file, const std::vector<Eigen::Vector3f>& points) {
  static_assert(std::endian::native == std::endian::little, "the PLY writer copies floats as they lie in memory");
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::size_t header = text.size();
  text.resize(header + points.size() * 3 * sizeof(float));
  char* out = text.data() + header;
  for (const Eigen::Vector3f& point : points) {
    std::memcpy(out, point.data(), 3 * sizeof(float));
    out += 3 * sizeof(float);
  }
  WriteFileAtomically(file, text);
}

}  // namespace formats
