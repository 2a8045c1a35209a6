// SPDX-License-Identifier: Apache-2.0
#include "formats/crs_area.h"

#include <cpl_error.h>
#include <ogr_spatialref.h>

#include <cmath>

#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

constexpr double kZonePrefix = 1e6;  // 32500000: the number of a zone before the easting

// GDAL must not print: what is wrong is told by our own messages.
class QuietGdal {
 public:
  QuietGdal() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

}  // namespace

struct CrsArea::Impl {
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0;  // deg
  bool known = false;
  std::unique_ptr<OGRCoordinateTransformation> geographic_from_projected;
};

CrsArea::CrsArea(const std::string& crs) : impl_(std::make_unique<Impl>()) {
  const QuietGdal quiet;
  OGRSpatialReference projected;
  if (projected.SetFromUserInput(crs.c_str()) != OGRERR_NONE) throw UsageError("crs = \"" + crs + "\": not known");
  if (projected.IsProjected() == 0) throw UsageError("crs = \"" + crs + "\": must be a projected system (metres)");
  projected.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const char* area_name = nullptr;
  impl_->known = projected.GetAreaOfUse(&impl_->west, &impl_->south, &impl_->east, &impl_->north, &area_name) &&
                 impl_->west > -1000.0 && impl_->west < impl_->east;
  if (!impl_->known) return;
  std::unique_ptr<OGRSpatialReference> geographic(projected.CloneGeogCS());
  geographic->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  impl_->geographic_from_projected.reset(OGRCreateCoordinateTransformation(&projected, geographic.get()));
  impl_->known = impl_->geographic_from_projected != nullptr;
}

CrsArea::~CrsArea() = default;

bool CrsArea::Contains(const Eigen::Vector2d& east_north) const {
  if (!impl_->known) return true;
  const QuietGdal quiet;
  double longitude = east_north.x();
  double latitude = east_north.y();
  if (impl_->geographic_from_projected->Transform(1, &longitude, &latitude) == 0) return false;
  return longitude >= impl_->west && longitude <= impl_->east && latitude >= impl_->south && latitude <= impl_->north;
}

void CheckControlArea(const std::vector<survey::ControlPoint>& points, const std::string& crs,
                      const std::vector<std::string>& where, std::vector<std::string>* warnings) {
  if (crs.empty()) return;
  const CrsArea area(crs);
  std::size_t num_outside = 0;
  std::string first;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& p = points[i].position_in_site;
    if (points[i].covariance.isZero(0.0) || area.Contains(p)) continue;
    if (area.Contains({p.y(), p.x()})) {
      throw DataError(where[i] + "point " + points[i].name +
                      ": northing and easting look exchanged: as read, northing " + NumberText(p.y()) + ", easting " +
                      NumberText(p.x()) + " lies outside the area of use of " + crs + "; exchanged, northing " +
                      NumberText(p.x()) + ", easting " + NumberText(p.y()) + " lies inside");
    }
    const double without_zone = std::fmod(p.x(), kZonePrefix);
    if (p.x() > kZonePrefix && area.Contains({without_zone, p.y()})) {
      throw DataError(where[i] + "point " + points[i].name + ": easting " + NumberText(p.x()) +
                      " carries the number of a zone in front: " + NumberText(without_zone) +
                      " lies inside the area of use of " + crs);
    }
    if (num_outside++ == 0) first = where[i] + "point " + points[i].name;
  }
  if (num_outside == 0) return;
  warnings->push_back(first + (num_outside > 1 ? " and " + std::to_string(num_outside - 1) + " more of " : " of ") +
                      std::to_string(points.size()) + " points lie outside the area of use of " + crs);
}

}  // namespace formats
