// SPDX-License-Identifier: Apache-2.0
#include "formats/grid_scale.h"

#include <ogr_spatialref.h>

#include <GeographicLib/Geodesic.hpp>
#include <cmath>
#include <memory>

#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

constexpr double kHalfBaseM = 50.0;

struct Place {
  double latitude = 0.0, longitude = 0.0;  // deg
};

}  // namespace

GridScale GridScaleAt(const std::string& crs, const Eigen::Vector2d& east_north, double ellipsoidal_height_m) {
  const GdalSession quiet;
  OGRSpatialReference projected;
  if (projected.SetFromUserInput(crs.c_str()) != OGRERR_NONE) throw UsageError("crs = \"" + crs + "\": not known");
  if (projected.IsProjected() == 0) throw UsageError("crs = \"" + crs + "\": must be a projected system");
  projected.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRSpatialReference> geographic(projected.CloneGeogCS());
  geographic->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&projected, geographic.get()));
  const auto place_of = [&](double east, double north) {
    Place place{.latitude = north, .longitude = east};
    if (!transformation || transformation->Transform(1, &place.longitude, &place.latitude) == 0) {
      throw DataError("east " + NumberText(east) + ", north " + NumberText(north) + " has no place in " + crs);
    }
    return place;
  };
  const double a = projected.GetSemiMajor(), f = 1.0 / projected.GetInvFlattening();
  const GeographicLib::Geodesic earth(a, f);
  double sum = 0.0;
  for (const Eigen::Vector2d& half : {Eigen::Vector2d(kHalfBaseM, 0.0), Eigen::Vector2d(0.0, kHalfBaseM)}) {
    const Place from = place_of(east_north.x() - half.x(), east_north.y() - half.y());
    const Place to = place_of(east_north.x() + half.x(), east_north.y() + half.y());
    double distance = 0.0;
    earth.Inverse(from.latitude, from.longitude, to.latitude, to.longitude, distance);
    sum += 2.0 * kHalfBaseM / distance;
  }
  const double sine = std::sin(place_of(east_north.x(), east_north.y()).latitude * M_PI / 180.0);
  const double e2 = f * (2.0 - f);
  const double radius = a * std::sqrt(1.0 - e2) / (1.0 - e2 * sine * sine);
  return {.projection = sum / 2.0, .height = radius / (radius + ellipsoidal_height_m), .radius_m = radius};
}

}  // namespace formats
