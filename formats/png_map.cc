// SPDX-License-Identifier: Apache-2.0
#include "formats/png_map.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <ogr_spatialref.h>

#include <cstdio>
#include <string>
#include <vector>

#include "formats/map_codes.h"
#include "formats/map_greys.h"
#include "formats/raster_crs.h"

namespace formats {
namespace {

// Two more make files 2 % smaller in half as much time again.
constexpr const char* kDeflateLevel = "4";

std::string Fixed(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.10f", value);
  return buffer;
}

// Six lines A D B E C F; C F is the centre of the upper left pixel.
std::string WorldFileOf(const survey::SiteRaster& raster) {
  const Eigen::Vector2d centre = raster.CentreOf(0, raster.height - 1);
  return Fixed(raster.cell_size_m) + "\n" + Fixed(0) + "\n" + Fixed(0) + "\n" + Fixed(-raster.cell_size_m) + "\n" +
         Fixed(centre.x()) + "\n" + Fixed(centre.y()) + "\n";
}

// What GDAL and QGIS look for beside a picture. WKT1 where it can say it (older readers), else WKT2.
std::string AuxXmlOf(const RasterLabel& label) {
  const GdalSession session;
  OGRSpatialReference crs;
  crs.importFromWkt(Wkt2OfLabel(label).c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  char* wkt = nullptr;
  if (!crs.IsProjected() || crs.exportToWkt(&wkt) != OGRERR_NONE) {
    CPLFree(wkt);
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    crs.exportToWkt(&wkt, options);
  }
  char* escaped = CPLEscapeString(wkt, -1, CPLES_XML_BUT_QUOTES);
  std::string axes;
  for (const int axis : crs.GetDataAxisToSRSAxisMapping()) axes += (axes.empty() ? "" : ",") + std::to_string(axis);
  std::string text = "<PAMDataset>\n  <SRS dataAxisToSRSAxisMapping=\"" + axes + "\">" + escaped +
                     "</SRS>\n  <Metadata>\n    <MDI key=\"PLUMBLINE_TIED\">" + (label.tied ? "yes" : "no") +
                     "</MDI>\n  </Metadata>\n</PAMDataset>\n";
  CPLFree(escaped);
  CPLFree(wkt);
  return text;
}

}  // namespace

PngMap::PngMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
               const GdalSession& session)
    : file_(file), frame_(strips.frame), label_(label), scratch_(file, strips.frame, 1, session) {}

void PngMap::Take(int first_row, const survey::SiteRaster& rows) {
  std::vector<std::uint8_t> greys = CodesFromNorth(rows, &survey::SiteRaster::log_odds, &PictureGrey);
  scratch_.Write(1, first_row, greys);
}

void PngMap::Finish() {
  CPLStringList options;
  options.SetNameValue("ZLEVEL", kDeflateLevel);
  scratch_.CopyTo("PNG", options.List());
  WriteFileAtomically(std::filesystem::path(file_).replace_extension(".pgw"), WorldFileOf(frame_));
  WriteFileAtomically(file_.string() + ".aux.xml", AuxXmlOf(label_));
}

}  // namespace formats
