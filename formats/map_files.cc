// SPDX-License-Identifier: Apache-2.0
#include "formats/map_files.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "formats/cog_map.h"
#include "formats/gdal_session.h"
#include "formats/map_writer.h"
#include "formats/png_map.h"
#include "formats/raster_description.h"
#include "formats/raster_file.h"
#include "formats/ros_map.h"

namespace formats {

void WriteInOnePass(const survey::RasterStrips& strips, std::span<MapWriter* const> writers) {
  constexpr int kRowsAtATime = 512;
  const survey::SiteRaster& frame = strips.frame;
  for (int first = 0; first < frame.height; first += kRowsAtATime) {
    const int height = std::min(kRowsAtATime, frame.height - first);
    const survey::SiteRaster rows = strips.read(frame.min_row + frame.height - first - height, height);
    for (MapWriter* writer : writers) writer->Take(first, rows);
  }
  for (MapWriter* writer : writers) writer->Finish();
}

void WriteMapFiles(const MapFiles& files, const survey::RasterStrips& strips, const RasterLabel& label,
                   const Provenance& provenance) {
  const GdalSession session;
  std::optional<CogMap> tif;
  std::optional<PngMap> png;
  std::optional<RosMap> ros;
  std::vector<MapWriter*> writers;
  for (const std::filesystem::path& file : {files.tif, files.png, files.ros}) {
    if (!file.empty()) RequireCells(file, strips.frame);
  }
  if (!files.tif.empty()) writers.push_back(&tif.emplace(files.tif, strips, label, provenance, session));
  if (!files.png.empty()) writers.push_back(&png.emplace(files.png, strips, label, session));
  if (!files.ros.empty()) writers.push_back(&ros.emplace(files.ros, "map", "", strips, label));
  WriteInOnePass(strips, writers);
}

void WriteCogMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance) {
  WriteMapFiles({.tif = file, .png = {}, .ros = {}}, strips, label, provenance);
}

void WriteCogMap(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  WriteCogMap(file, survey::StripsOf(raster), label, provenance);
}

void WritePngMap(const std::filesystem::path& file, const survey::RasterStrips& strips, const RasterLabel& label) {
  WriteMapFiles({.tif = {}, .png = file, .ros = {}}, strips, label, {});
}

void WritePngMap(const std::filesystem::path& file, const survey::SiteRaster& raster, const RasterLabel& label) {
  WritePngMap(file, survey::StripsOf(raster), label);
}

void WriteRosMap(const std::filesystem::path& folder, const survey::RasterStrips& strips, const RasterLabel& label) {
  WriteMapFiles({.tif = {}, .png = {}, .ros = folder}, strips, label, {});
}

void WriteRosMap(const std::filesystem::path& folder, const survey::SiteRaster& raster, const RasterLabel& label) {
  WriteRosMap(folder, survey::StripsOf(raster), label);
}

void WriteKeepoutMask(const std::filesystem::path& folder, const survey::RasterStrips& strips,
                      const RasterLabel& label) {
  RosMap mask(folder, "keepout",
              "# mask of a Nav2 keep-out filter (CostmapFilterInfo: type 0, base 0.0, multiplier 1.0): black is "
              "forbidden\n",
              strips, label);
  MapWriter* const writers[] = {&mask};
  WriteInOnePass(strips, writers);
}

}  // namespace formats
