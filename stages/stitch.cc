// SPDX-License-Identifier: Apache-2.0
//
// plumbline-stitch: the site map out of the block maps, and how well they agree. Only blocks that are tied to control
// are put together; others are delivered apart, in their local frames and labelled so. A single block that is not tied
// is the site in its local frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <list>
#include <memory>
#include <optional>

#include "formats/artefacts.h"
#include "formats/map_files.h"
#include "formats/raster_file.h"
#include "formats/seams_file.h"
#include "pipeline/descent.h"
#include "pipeline/stage.h"
#include "survey/accuracy/seam_test.h"
#include "survey/grid/coverage.h"
#include "survey/grid/mosaic.h"
#include "survey/grid/seams.h"
#include "survey/grid/seen_tiles.h"

namespace {

namespace fs = std::filesystem;

struct BlockMap {
  std::string name;
  fs::path file;
  survey::RasterStrips map;
  formats::RasterLabel label;
  fs::path solution;
};

// An offset between two rasters is read to about this part of a cell, 1 sigma.
constexpr double kReadingSigmaCells = 0.2;

// The solution that is given for the block; its map must descend from it.
fs::path SolutionOf(const BlockMap& block, const std::vector<pipeline::NamedFile>& solutions) {
  const auto solution = std::find_if(solutions.begin(), solutions.end(),
                                     [&](const pipeline::NamedFile& named) { return named.name == block.name; });
  if (solution == solutions.end())
    throw formats::UsageError("--solution " + block.name + "=FILE is missing beside --map " + block.name + "=FILE");
  pipeline::RequireDescent(block.file, solution->file);
  return solution->file;
}

void RequireSameRaster(const BlockMap& a, const BlockMap& b) {
  const auto differ = [&](const std::string& what, const std::string& of_a, const std::string& of_b) {
    throw formats::DataError(a.file.string() + " and " + b.file.string() + " have different " + what + ": " + of_a +
                             " and " + of_b);
  };
  if (a.map.frame.cell_size_m != b.map.frame.cell_size_m)
    differ("cell sizes", std::to_string(a.map.frame.cell_size_m) + " m",
           std::to_string(b.map.frame.cell_size_m) + " m");
  if (a.label.tied && b.label.tied && a.label.frame.crs != b.label.frame.crs)
    differ("coordinate systems", a.label.frame.crs.empty() ? "none" : a.label.frame.crs,
           b.label.frame.crs.empty() ? "none" : b.label.frame.crs);
}

std::vector<BlockMap> ReadMaps(const std::vector<pipeline::NamedFile>& maps,
                               const std::vector<pipeline::NamedFile>& solutions) {
  std::vector<BlockMap> blocks;
  for (const pipeline::NamedFile& map : maps) {
    BlockMap block{.name = map.name, .file = map.file};
    block.map = formats::OpenRaster(map.file, &block.label);
    block.solution = SolutionOf(block, solutions);
    for (const BlockMap& other : blocks) {
      if (other.name == block.name) throw formats::UsageError("--map " + block.name + " is given twice");
    }
    if (!blocks.empty()) RequireSameRaster(blocks.front(), block);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

formats::MapFiles FilesOf(const fs::path& tif) {
  return {.tif = tif, .png = fs::path(tif).replace_extension(".png"), .ros = {}};
}

// The log-odds themselves, for whoever wants to compute with them.
void WriteArchive(bool wanted, const fs::path& tif, const survey::RasterStrips& map, const formats::RasterLabel& label,
                  const formats::Provenance& provenance) {
  if (!wanted) fs::remove(tif);
  if (wanted) formats::WriteRaster(tif, map, label, provenance);
}

void RemoveMap(const fs::path& tif) {
  for (const char* extension : {".tif", ".png", ".pgw", ".png.aux.xml"}) {
    fs::remove(fs::path(tif).replace_extension(extension));
  }
}

// Maps of blocks that are no longer delivered apart must not stay behind.
void RemoveOldLocalMaps(const fs::path& output, const formats::SeamsReport& report) {
  std::vector<fs::path> old;
  if (fs::is_directory(output / "local")) {
    for (const fs::directory_entry& entry : fs::directory_iterator(output / "local")) {
      if (entry.path().extension() == ".tif") old.push_back(entry.path());
    }
  }
  for (const fs::path& tif : old) {
    const bool delivered = std::any_of(report.blocks.begin(), report.blocks.end(),
                                       [&](const formats::StitchedBlock& block) { return output / block.map == tif; });
    if (!delivered) RemoveMap(tif);
  }
}

struct SeamSearch {
  survey::SeamOptions seam;
  double min_overlap_m2 = 4.0;  // that two blocks must have seen both to be neighbours
};

// Empty: both have not seen enough for a seam. Of the pair only what both may have seen is looked at.
std::optional<survey::Seam> CompareTwo(const survey::FacedTiles& first, const survey::FacedTiles& second,
                                       const survey::CellBox& common, double cell_m, const SeamSearch& search) {
  const std::int64_t margin = survey::SeamMarginCells(search.seam, cell_m);
  survey::Seam seam = survey::CompareMaps(first.Part(common, margin), second.Part(common, margin), search.seam);
  if (seam.overlap_area_m2 == 0.0 || seam.overlap_area_m2 < search.min_overlap_m2) return std::nullopt;
  return seam;
}

// A block while it is compared with its neighbours.
struct LoadedBlock {
  survey::FacedTiles map;
  survey::Solution solution;

  LoadedBlock(const BlockMap& block, const survey::SeamOptions& options)
      : map(block.map, options), solution(formats::ReadSolution(block.solution)) {}
  std::size_t bytes() const { return map.bytes() + solution.scans.size() * sizeof(survey::SolvedScan); }
};

// The blocks that were used last stay in memory, up to a limit: neighbours are compared soon after each other.
class LoadedBlocks {
 public:
  LoadedBlocks(const std::vector<const BlockMap*>& blocks, const survey::SeamOptions& options)
      : blocks_(blocks), options_(options) {}

  std::shared_ptr<const LoadedBlock> Of(std::size_t index) {
    const auto found =
        std::find_if(last_used_.begin(), last_used_.end(), [&](const Entry& entry) { return entry.first == index; });
    if (found != last_used_.end()) {
      last_used_.splice(last_used_.begin(), last_used_, found);
    } else {
      last_used_.emplace_front(index, std::make_shared<LoadedBlock>(*blocks_[index], options_));
      bytes_ += last_used_.front().second->bytes();
    }
    while (bytes_ > kMostBytes && last_used_.size() > 1) {
      bytes_ -= last_used_.back().second->bytes();
      last_used_.pop_back();
    }
    return last_used_.front().second;
  }

 private:
  using Entry = std::pair<std::size_t, std::shared_ptr<const LoadedBlock>>;
  static constexpr std::size_t kMostBytes = std::size_t{128} << 20;

  const std::vector<const BlockMap*>& blocks_;
  const survey::SeamOptions& options_;
  std::list<Entry> last_used_;  // the last one first
  std::size_t bytes_ = 0;
};

std::vector<formats::BlockSeam> CompareAll(const std::vector<const BlockMap*>& blocks, const SeamSearch& search,
                                           pipeline::StageRun& run) {
  if (blocks.size() < 2) return {};
  std::vector<survey::Coverage> coverages;
  for (const BlockMap* block : blocks) coverages.emplace_back(block->map);
  LoadedBlocks loaded(blocks, search.seam);
  const double cell_m = blocks.front()->map.frame.cell_size_m;
  std::vector<formats::BlockSeam> seams;
  pipeline::Progress progress = run.Track("blocks", static_cast<std::int64_t>(blocks.size()));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t j = i + 1; j < blocks.size(); ++j) {
      const survey::CommonCoverage common = coverages[i].With(coverages[j]);
      const double at_most_m2 = static_cast<double>(common.max_cells) * cell_m * cell_m;
      if (common.max_cells == 0 || at_most_m2 < search.min_overlap_m2) continue;
      const std::shared_ptr<const LoadedBlock> first = loaded.Of(i), second = loaded.Of(j);
      std::optional<survey::Seam> seam = CompareTwo(first->map, second->map, common.box, cell_m, search);
      if (!seam) continue;
      const auto verdict = survey::JudgeSeam(*seam, first->solution, second->solution, kReadingSigmaCells * cell_m);
      seams.push_back({blocks[i]->name, blocks[j]->name, *std::move(seam), verdict});
    }
    progress.Advance(static_cast<std::int64_t>(i + 1));
  }
  return seams;
}

std::string ContradictionText(const formats::BlockSeam& seam) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      " contradict each other beyond their covariance: mean offset %.1f sigmas, %d of %zu windows beyond; see "
      "seams.geojson",
      seam.verdict->ratio.value_or(0.0), seam.verdict->num_beyond, seam.seam.patches.size());
  return "blocks " + seam.first + " and " + seam.second + text;
}

void Summarize(const std::vector<formats::BlockSeam>& seams, pipeline::StageRun& run) {
  for (const formats::BlockSeam& one : seams) {
    char text[160];
    if (one.seam.rms_m) {
      std::snprintf(text, sizeof text, ": %.0f m2 of overlap, %zu windows, rms offset %.3f m, contradicted %.1f %%",
                    one.seam.overlap_area_m2, one.seam.patches.size(), *one.seam.rms_m,
                    100 * std::max(one.seam.first_contradicted_share, one.seam.second_contradicted_share));
    } else {
      std::snprintf(text, sizeof text, ": %.0f m2 of overlap, too little structure for an offset",
                    one.seam.overlap_area_m2);
    }
    run.Message(one.first + " - " + one.second + text);
    if (one.verdict && one.verdict->contradicts) run.Warn(ContradictionText(one));
  }
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("stitch", "Put the maps of the tied blocks together and compare them where they overlap.",
                        "plumbline stitch --map B1=work/B1/map.tif --solution B1=work/B1/solution.sqlite --output out");
  std::vector<pipeline::NamedFile> maps;
  std::vector<pipeline::NamedFile> solutions;
  fs::path output;
  SeamSearch search;
  bool archive = false;
  stage.NamedInputs("map", &maps, "map of each block", true);
  stage.NamedInputs("solution", &solutions, "solution of each block", true);
  stage.Output("output", &output, "folder for site.tif, site.png, ros/, local/, seams.json and seams.geojson");
  stage.Option("seam-window-m", &search.seam.window_m, "side of the windows that give one offset each (m)",
               {.min = 1.0, .max = 100.0});
  stage.Option("seam-search-m", &search.seam.search_m, "largest offset between two maps that is looked for (m)",
               {.min = 0.1, .max = 5.0});
  stage.Option("wall-tolerance-m", &search.seam.wall_tolerance_m,
               "a wall within this of a wall in the other map is not contradicted (m)", {.min = 0.0, .max = 2.0});
  stage.Option("seam-min-overlap-m2", &search.min_overlap_m2,
               "two maps are compared where both have seen this much (m2)", {.min = 0.0});
  stage.Option("float-archive", &archive, "true: site-log-odds.tif too, the log-odds of the site map as Float32");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    const std::vector<BlockMap> blocks = ReadMaps(maps, solutions);
    std::vector<const BlockMap*> site_blocks;
    for (const BlockMap& block : blocks) {
      if (block.label.tied || blocks.size() == 1) site_blocks.push_back(&block);
    }
    formats::SeamsReport report{.cell_size_m = blocks.front().map.frame.cell_size_m};
    std::vector<survey::RasterStrips> site_maps;
    for (const BlockMap* block : site_blocks) site_maps.push_back(block->map);
    for (const BlockMap& block : blocks) {
      const bool in_site = std::find(site_blocks.begin(), site_blocks.end(), &block) != site_blocks.end();
      report.blocks.push_back({block.name, block.label.tied, in_site ? "site.tif" : "local/" + block.name + ".tif"});
      if (!block.label.tied)
        run.Warn(block.name + " is not tied to control: " + report.blocks.back().map + " is in its local frame");
      if (in_site) continue;
      formats::WriteMapFiles(FilesOf(output / report.blocks.back().map), block.map, block.label, run.Provenance());
    }
    RemoveOldLocalMaps(output, report);
    const fs::path site = output / "site.tif";
    if (site_blocks.empty()) {
      run.Warn("no block is tied to control: the blocks cannot be put together and there is no site map");
      RemoveMap(site);
      fs::remove_all(output / "ros");
    } else {
      report.label = site_blocks.front()->label;
      const survey::RasterStrips mosaic = survey::MosaicOf(site_maps, {});
      formats::MapFiles files = FilesOf(site);
      files.ros = output / "ros";
      formats::WriteMapFiles(files, mosaic, report.label, run.Provenance());
      WriteArchive(archive, output / "site-log-odds.tif", mosaic, report.label, run.Provenance());
      report.seams = CompareAll(site_blocks, search, run);
    }
    formats::WriteSeams(output / "seams.json", report, run.Provenance());
    formats::WriteSeamsLayer(output / "seams.geojson", report);
    Summarize(report.seams, run);
  });
}
