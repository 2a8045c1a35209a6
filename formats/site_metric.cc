// SPDX-License-Identifier: Apache-2.0
#include "formats/site_metric.h"

#include <cstdio>

#include "formats/errors.h"

namespace formats {
namespace {

constexpr const char* kGrid = "grid";

std::optional<GridScale> ScaleAt(const std::string& crs, const Eigen::Vector2d& place, double height_m) {
  try {
    return GridScaleAt(crs, place, height_m);
  } catch (const DataError&) {
    return std::nullopt;  // outside of what the projection can invert: nothing is said
  }
}

// Of the points with a place; the elevation of those that have one.
struct ControlCentre {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  std::optional<double> elevation_m;
};

ControlCentre CentreOf(const survey::ControlNetwork& network) {
  ControlCentre centre;
  double elevations = 0.0;
  int num_places = 0, num_elevations = 0;
  for (const survey::ControlPoint& point : network.points) {
    if (point.role != survey::PointRole::kControl && point.role != survey::PointRole::kCheck) continue;
    centre.place += point.position_in_site;
    ++num_places;
    if (!point.elevation_m) continue;
    elevations += *point.elevation_m;
    ++num_elevations;
  }
  if (num_places > 0) centre.place /= num_places;
  if (num_elevations > 0) centre.elevation_m = elevations / num_elevations;
  return centre;
}

std::string Factor(double factor) {
  char text[32];
  std::snprintf(text, sizeof text, "%.8f", factor);
  return text;
}

}  // namespace

SiteMetric MetricAt(const RasterLabel& label, const Eigen::Vector2d& place) {
  if (!label.tied) return {.distances = "local", .scale = {}};
  if (label.frame.crs.empty()) return {.distances = "plane of the control", .scale = {}};
  return {.distances = kGrid, .scale = ScaleAt(label.frame.crs, place, 0.0)};
}

std::string MetricText(const SiteMetric& metric) {
  if (metric.distances != kGrid) return "distances as measured, metres; not reduced to any grid";
  if (!metric.scale) return "grid distances, metres";
  char radius[64];
  std::snprintf(radius, sizeof radius, " R / (R + h)), R = %.0f km, h above the ellipsoid",
                metric.scale->radius_m / 1000.0);
  return "grid distances, metres; ground = grid / (" + Factor(metric.scale->projection) + radius;
}

std::string MetricSentence(const survey::ControlNetwork& network) {
  const std::string& crs = network.frame.crs;
  if (crs.empty())
    return "Distances are metres in the control's own plane, as its coordinates have them; no projection is known, so "
           "no "
           "combined factor is applied or stated.";
  const ControlCentre centre = CentreOf(network);
  const std::string grid = "Distances are metres on the grid of " + crs;
  const std::optional<GridScale> scale = ScaleAt(crs, centre.place, centre.elevation_m.value_or(0.0));
  if (!scale) return grid + ".";
  const std::string middle = grid + ": point scale " + Factor(scale->projection) + " at the middle of the control";
  if (!centre.elevation_m) return middle + "; the combined factor needs heights.";
  char height[160];
  std::snprintf(
      height, sizeof height,
      " (ground times it is grid) at the mean elevation of %.0f m taken as a height above the ellipsoid; 50 m "
      "of geoid change it by 8 ppm.",
      *centre.elevation_m);
  return middle + ", combined factor " + Factor(scale->Combined()) + height;
}

}  // namespace formats
