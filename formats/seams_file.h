// SPDX-License-Identifier: Apache-2.0
//
// seams.json: which blocks make the site map and how well they agree where they overlap. Schema in README.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/provenance.h"
#include "formats/raster_file.h"
#include "survey/accuracy/seam_test.h"
#include "survey/grid/seams.h"

namespace formats {

struct StitchedBlock {
  std::string name;
  bool tied = false;  // to control
  std::string map;    // the deliverable that shows it, relative to seams.json: "site.tif" or "local/B1.tif"
};

struct BlockSeam {
  std::string first;
  std::string second;
  survey::Seam seam;
  std::optional<survey::SeamVerdict> verdict;  // against the covariances of the two blocks
};

struct SeamsReport {
  RasterLabel label;  // of the site map
  double cell_size_m = 0.0;
  std::vector<StitchedBlock> blocks;
  std::vector<BlockSeam> seams;  // pairs of tied blocks that overlap
};

// seams.geojson: each window's offset as a line, kOffsetEnlargement times its length, with its numbers.
constexpr double kOffsetEnlargement = 100.0;
void WriteSeamsLayer(const std::filesystem::path& file, const SeamsReport& report);

void WriteSeams(const std::filesystem::path& file, const SeamsReport& report, const Provenance& provenance);

}  // namespace formats
