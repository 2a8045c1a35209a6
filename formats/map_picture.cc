// SPDX-License-Identifier: Apache-2.0
//
// Pictures of a map: PNG with world file and CRS, and the ROS map_server pair.
#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <span>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_crs.h"
#include "formats/raster_description.h"
#include "formats/raster_file.h"
#include "formats/scratch_raster.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::SiteRaster;

// The thresholds of ROS map_server; its saver's grey for unknown reads back as 0.196078 > kFree.
constexpr float kOccupied = 0.65F;
constexpr float kFree = 0.196F;
constexpr std::uint8_t kUnknownGrey = 205;

// White up to kFree, black from kOccupied, shades between.
std::uint8_t PictureGrey(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownGrey;
  const float blackness = (survey::ProbabilityFromLogOdds(log_odds) - kFree) / (kOccupied - kFree);
  return static_cast<std::uint8_t>(std::lround(255.0F * (1.0F - std::clamp(blackness, 0.0F, 1.0F))));
}

std::uint8_t RosGrey(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownGrey;
  const float probability = survey::ProbabilityFromLogOdds(log_odds);
  if (probability >= kOccupied) return 0;
  return probability <= kFree ? 254 : kUnknownGrey;
}

std::string Fixed(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.10f", value);
  return buffer;
}

// Six lines A D B E C F; C F is the centre of the upper left pixel.
std::string WorldFileOf(const SiteRaster& raster) {
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

void WritePgm(const fs::path& file, const survey::RasterStrips& strips) {
  AtomicFile output(file);
  std::ofstream pgm(output.temporary(), std::ios::binary);
  pgm << "P5\n" << strips.frame.width << " " << strips.frame.height << "\n255\n";
  ForEachStrip(strips, &SiteRaster::log_odds, &RosGrey, [&](int, std::span<std::uint8_t> rows) {
    pgm.write(reinterpret_cast<const char*>(rows.data()), static_cast<std::streamsize>(rows.size()));
  });
  pgm.close();
  if (!pgm) throw DataError(file.string() + ": could not be written (disk full?)");
  output.Commit();
}

std::string RosYaml(const SiteRaster& raster, const std::string& image, const std::string& comment, double origin_x,
                    double origin_y) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "resolution: %.10g\norigin: [%.4f, %.4f, 0.0]\n", raster.cell_size_m, origin_x,
                origin_y);
  return comment + "image: " + image + "\nmode: trinary\n" + numbers +
         "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

// name.pgm, name.yaml and name_local.yaml.
void WriteRosPicture(const fs::path& folder, const std::string& name, const std::string& remark,
                     const survey::RasterStrips& strips, const RasterLabel& label) {
  const SiteRaster& raster = strips.frame;
  const std::string image = name + ".pgm";
  WritePgm(folder / image, strips);
  const double origin_x = static_cast<double>(raster.min_column) * raster.cell_size_m;
  const double origin_y = static_cast<double>(raster.min_row) * raster.cell_size_m;
  const std::string crs = "# " + CrsNameOfLabel(label) + "; x east, y north, metres\n" + remark;
  WriteFileAtomically(folder / (name + ".yaml"),
                      RosYaml(raster, image,
                              crs +
                                  "# origin: lower left corner in site coordinates. Tools that keep positions as "
                                  "32-bit floats: use " +
                                  name + "_local.yaml.\n",
                              origin_x, origin_y));
  char offset[128];
  std::snprintf(offset, sizeof offset, ", lower left corner at 0 0: site = local + (%.4f, %.4f)\n", origin_x, origin_y);
  WriteFileAtomically(folder / (name + "_local.yaml"),
                      RosYaml(raster, image, crs + "# the picture of " + name + ".yaml" + offset, 0, 0));
}

}  // namespace

void WritePngMap(const fs::path& file, const survey::RasterStrips& strips, const RasterLabel& label) {
  RequireCells(file, strips.frame);
  {
    const GdalSession session;
    ScratchRaster scratch(file, strips.frame, 1, session);
    ForEachStrip(strips, &SiteRaster::log_odds, &PictureGrey,
                 [&](int first_row, std::span<std::uint8_t> rows) { scratch.Write(1, first_row, rows); });
    scratch.CopyTo("PNG", nullptr);
  }
  WriteFileAtomically(fs::path(file).replace_extension(".pgw"), WorldFileOf(strips.frame));
  WriteFileAtomically(file.string() + ".aux.xml", AuxXmlOf(label));
}

void WritePngMap(const fs::path& file, const SiteRaster& raster, const RasterLabel& label) {
  WritePngMap(file, survey::StripsOf(raster), label);
}

void WriteRosMap(const fs::path& folder, const survey::RasterStrips& strips, const RasterLabel& label) {
  WriteRosPicture(folder, "map", "", strips, label);
}

void WriteKeepoutMask(const fs::path& folder, const survey::RasterStrips& strips, const RasterLabel& label) {
  WriteRosPicture(folder, "keepout",
                  "# mask of a Nav2 keep-out filter (CostmapFilterInfo: type 0, base 0.0, multiplier 1.0): black is "
                  "forbidden\n",
                  strips, label);
}

void WriteRosMap(const fs::path& folder, const SiteRaster& raster, const RasterLabel& label) {
  WriteRosMap(folder, survey::StripsOf(raster), label);
}

}  // namespace formats
