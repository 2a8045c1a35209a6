// SPDX-License-Identifier: Apache-2.0
#include "formats/seams_file.h"

#include <algorithm>
#include <cmath>

#include "formats/atomic_file.h"
#include "formats/raster_crs.h"

namespace formats {
namespace {

using nlohmann::json;

// Tenths of a millimetre and of a per mille are plenty.
double Rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

json ToJson(const Eigen::Vector2d& v) { return {Rounded(v.x()), Rounded(v.y())}; }

json ToJson(const BlockSeam& block_seam) {
  const survey::Seam& seam = block_seam.seam;
  json patches = json::array();
  for (const survey::SeamPatch& patch : seam.patches) {
    patches.push_back({{"centre", ToJson(patch.centre_in_site)},
                       {"offset_m", ToJson(patch.offset)},
                       {"directions", patch.directions},
                       {"quality", Rounded(patch.quality)}});
  }
  return {{"blocks", {block_seam.first, block_seam.second}},
          {"overlap_area_m2", Rounded(seam.overlap_area_m2)},
          {"disagreeing_share", Rounded(seam.disagreeing_share)},
          {"contradicted_shares", {Rounded(seam.first_contradicted_share), Rounded(seam.second_contradicted_share)}},
          {"offset_m", seam.offset ? ToJson(*seam.offset) : json()},
          {"rms_m", seam.rms_m ? json(Rounded(*seam.rms_m)) : json()},
          {"patches", std::move(patches)}};
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
                         {"format_version", 1},
                         {"site_map", site ? json("site.tif") : json()},
                         {"tied", report.label.tied},
                         {"crs", CrsNameOfLabel(report.label)},
                         {"cell_size_m", report.cell_size_m},
                         {"blocks", std::move(blocks)},
                         {"seams", std::move(seams)},
                         {"provenance", ToJson(provenance)}};
  WriteFileAtomically(file, document.dump(1) + "\n");
}

}  // namespace formats
