// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_crs.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include "formats/errors.h"
#include "formats/gdal_session.h"

namespace formats {
namespace {

constexpr const char* kSitePlane = "site plane of the control";
constexpr const char* kNotTied = "local frame of the block, not tied to control";

std::string EngineeringCrs(const std::string& name) {
  return "ENGCRS[\"" + name + "\",EDATUM[\"" + name +
         "\"],CS[Cartesian,2],AXIS[\"easting (E)\",east,ORDER[1],LENGTHUNIT[\"metre\",1]],"
         "AXIS[\"northing (N)\",north,ORDER[2],LENGTHUNIT[\"metre\",1]]]";
}

// Easting and northing, in either order.
bool HasEastAndNorthAxes(const OGRSpatialReference& crs) {
  OGRAxisOrientation first = OAO_Other;
  OGRAxisOrientation second = OAO_Other;
  crs.GetAxis(nullptr, 0, &first);
  crs.GetAxis(nullptr, 1, &second);
  return (first == OAO_East && second == OAO_North) || (first == OAO_North && second == OAO_East);
}

}  // namespace

std::string Wkt2OfCrs(const std::string& crs) {
  if (crs.empty()) return "";
  const GdalSession session;
  OGRSpatialReference reference;
  const char* const import_options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
  if (reference.SetFromUserInput(crs.c_str(), import_options) != OGRERR_NONE)
    throw UsageError("crs = \"" + crs +
                     "\": not a known coordinate reference system (expected for example EPSG:25832)");
  if (!reference.IsProjected())
    throw UsageError("crs = \"" + crs + "\": is not a projected coordinate reference system; maps need plane metres");
  if (reference.GetLinearUnits() != 1.0) throw UsageError("crs = \"" + crs + "\": its unit is not the metre");
  if (!HasEastAndNorthAxes(reference)) throw UsageError("crs = \"" + crs + "\": its axes are not easting and northing");
  char* text = nullptr;
  const char* const export_options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const OGRErr status = reference.exportToWkt(&text, export_options);
  std::string wkt2 = text == nullptr ? "" : text;
  CPLFree(text);
  if (status != OGRERR_NONE || wkt2.empty())
    throw UsageError("crs = \"" + crs + "\": cannot be written as WKT2: " + session.failure());
  return wkt2;
}

std::string Wkt2OfLabel(const RasterLabel& label) {
  if (!label.tied) return EngineeringCrs(kNotTied);
  if (!label.frame.wkt2.empty()) return label.frame.wkt2;
  if (!label.frame.crs.empty()) return Wkt2OfCrs(label.frame.crs);
  return EngineeringCrs(kSitePlane);
}

std::string CrsNameOfLabel(const RasterLabel& label) {
  if (!label.tied) return kNotTied;
  return label.frame.crs.empty() ? kSitePlane : label.frame.crs;
}

}  // namespace formats
