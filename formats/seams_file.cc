// SPDX-License-Identifier: Apache-2.0
#include "formats/seams_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/json_text.h"
#include "formats/raster_crs.h"

namespace formats {
namespace {

using nlohmann::json;

// Tenths of a millimetre and of a per mille are plenty.
double Rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

json ToJson(const Eigen::Vector2d& v) { return {Rounded(v.x()), Rounded(v.y())}; }

// How many sigmas long the offset of a window is; null without covariances.
json SigmasOf(const BlockSeam& block_seam, std::size_t patch) {
  return block_seam.verdict ? json(Rounded(block_seam.verdict->patch_ratios[patch])) : json();
}

json ToJson(const BlockSeam& block_seam) {
  const survey::Seam& seam = block_seam.seam;
  json patches = json::array();
  for (std::size_t i = 0; i < seam.patches.size(); ++i) {
    const survey::SeamPatch& patch = seam.patches[i];
    patches.push_back({{"centre", ToJson(patch.centre_in_site)},
                       {"offset_m", ToJson(patch.offset)},
                       {"directions", patch.directions},
                       {"sigmas", SigmasOf(block_seam, i)},
                       {"quality", Rounded(patch.quality)}});
  }
  const std::optional<survey::SeamVerdict>& verdict = block_seam.verdict;
  return {{"blocks", {block_seam.first, block_seam.second}},
          {"overlap_area_m2", Rounded(seam.overlap_area_m2)},
          {"disagreeing_share", Rounded(seam.disagreeing_share)},
          {"contradicted_shares", {Rounded(seam.first_contradicted_share), Rounded(seam.second_contradicted_share)}},
          {"offset_m", seam.offset ? ToJson(*seam.offset) : json()},
          {"rms_m", seam.rms_m ? json(Rounded(*seam.rms_m)) : json()},
          {"sigmas", verdict && verdict->ratio ? json(Rounded(*verdict->ratio)) : json()},
          {"contradicts", verdict ? json(verdict->contradicts) : json()},
          {"patches", std::move(patches)}};
}

json LineOf(const BlockSeam& block_seam, std::size_t index) {
  const survey::SeamPatch& patch = block_seam.seam.patches[index];
  const Eigen::Vector2d end = patch.centre_in_site + kOffsetEnlargement * patch.offset;
  return {{"type", "Feature"},
          {"properties",
           {{"first", block_seam.first},
            {"second", block_seam.second},
            {"east_m", Rounded(patch.offset.x())},
            {"north_m", Rounded(patch.offset.y())},
            {"directions", patch.directions},
            {"sigmas", SigmasOf(block_seam, index)},
            {"quality", Rounded(patch.quality)}}},
          {"geometry", {{"type", "LineString"}, {"coordinates", {ToJson(patch.centre_in_site), ToJson(end)}}}}};
}

}  // namespace

void WriteSeams(const std::filesystem::path& file, const SeamsReport& report, const Provenance& provenance) {
  json blocks = json::array();
  for (const StitchedBlock& block : report.blocks) {
    blocks.push_back({{"name", block.name}, {"tied", block.tied}, {"map", block.map}});
  }
  json seams = json::array();
  for (const BlockSeam& seam : report.seams) seams.push_back(ToJson(seam));
  const bool site = std::any_of(report.blocks.begin(), report.blocks.end(),
                                [](const StitchedBlock& block) { return block.map == "site.tif"; });
  const json document = {{"format", "plumbline-seams"},
                         {"format_version", 2},
                         {"site_map", site ? json("site.tif") : json()},
                         {"tied", report.label.tied},
                         {"crs", CrsNameOfLabel(report.label)},
                         {"cell_size_m", report.cell_size_m},
                         {"blocks", std::move(blocks)},
                         {"seams", std::move(seams)},
                         {"provenance", ToJson(provenance)}};
  WriteJson(file, document);
}

void WriteSeamsLayer(const std::filesystem::path& file, const SeamsReport& report) {
  json features = json::array();
  for (const BlockSeam& seam : report.seams) {
    for (std::size_t i = 0; i < seam.seam.patches.size(); ++i) features.push_back(LineOf(seam, i));
  }
  json document = {{"type", "FeatureCollection"}, {"name", "seams"}, {"features", std::move(features)}};
  // GeoJSON of 2008; GDAL and QGIS take a projected system from it.
  const std::string& crs = report.label.frame.crs;
  if (crs.starts_with("EPSG:")) {
    document["crs"] = {{"type", "name"}, {"properties", {{"name", "urn:ogc:def:crs:EPSG::" + crs.substr(5)}}}};
  }
  WriteJson(file, document);
}

}  // namespace formats
