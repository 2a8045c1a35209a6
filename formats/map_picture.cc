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
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_crs.h"
#include "formats/raster_file.h"

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

// Rows from the north.
template <typename GreyOf>
std::vector<std::uint8_t> ImageOf(const SiteRaster& raster, GreyOf grey_of) {
  std::vector<std::uint8_t> image;
  image.reserve(raster.log_odds.size());
  for (int row = raster.height - 1; row >= 0; --row) {
    for (int column = 0; column < raster.width; ++column) image.push_back(grey_of(raster.At(column, row)));
  }
  return image;
}

void WritePng(const fs::path& file, std::vector<std::uint8_t> image, int width, int height) {
  AtomicFile output(file);
  const GdalSession session;
  GDALDriverManager* drivers = GetGDALDriverManager();
  const GDALDatasetUniquePtr memory(drivers->GetDriverByName("MEM")->Create("", width, height, 1, GDT_Byte, nullptr));
  if (!memory || memory->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, width, height, image.data(), width, height,
                                                    GDT_Byte, 0, 0, nullptr) != CE_None)
    session.Throw(file, "could not be composed in memory");
  GDALDatasetUniquePtr data(drivers->GetDriverByName("PNG")->CreateCopy(output.temporary().c_str(), memory.get(), TRUE,
                                                                        nullptr, nullptr, nullptr));
  const bool created = data != nullptr;
  data.reset();
  if (!created) session.Throw(file, "could not be written (disk full?)");
  session.ThrowIfFailed(file, "could not be written (disk full?)");
  output.Commit();
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

std::string RosYaml(const SiteRaster& raster, const std::string& comment, double origin_x, double origin_y) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "resolution: %.10g\norigin: [%.4f, %.4f, 0.0]\n", raster.cell_size_m, origin_x,
                origin_y);
  return comment + "image: map.pgm\nmode: trinary\n" + numbers +
         "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

}  // namespace

void WritePngMap(const fs::path& file, const SiteRaster& raster, const RasterLabel& label) {
  if (raster.width <= 0 || raster.height <= 0) throw DataError(file.string() + ": the raster has no cells");
  WritePng(file, ImageOf(raster, PictureGrey), raster.width, raster.height);
  WriteFileAtomically(fs::path(file).replace_extension(".pgw"), WorldFileOf(raster));
  WriteFileAtomically(file.string() + ".aux.xml", AuxXmlOf(label));
}

void WriteRosMap(const fs::path& folder, const SiteRaster& raster, const RasterLabel& label) {
  const std::vector<std::uint8_t> image = ImageOf(raster, RosGrey);
  std::string pgm = "P5\n" + std::to_string(raster.width) + " " + std::to_string(raster.height) + "\n255\n";
  pgm.append(image.begin(), image.end());
  WriteFileAtomically(folder / "map.pgm", pgm);
  const double origin_x = static_cast<double>(raster.min_column) * raster.cell_size_m;
  const double origin_y = static_cast<double>(raster.min_row) * raster.cell_size_m;
  const std::string crs = "# " + CrsNameOfLabel(label) + "; x east, y north, metres\n";
  WriteFileAtomically(folder / "map.yaml",
                      RosYaml(raster,
                              crs + "# origin: lower left corner in site coordinates. Tools that keep positions as "
                                    "32-bit floats: use map_local.yaml.\n",
                              origin_x, origin_y));
  char offset[128];
  std::snprintf(offset, sizeof offset,
                "# the picture of map.yaml, lower left corner at 0 0: site = local + (%.4f, %.4f)\n", origin_x,
                origin_y);
  WriteFileAtomically(folder / "map_local.yaml", RosYaml(raster, crs + offset, 0, 0));
}

}  // namespace formats
