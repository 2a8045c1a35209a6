// SPDX-License-Identifier: Apache-2.0
#include "stages/review/tile_layers.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "formats/digest.h"
#include "pipeline/file_state.h"
#include "pipeline/site_layout.h"

namespace review {
namespace {

namespace fs = std::filesystem;
using formats::MapTiles;
using nlohmann::json;

json Describe(const TileLayer& layer, const MapTiles::Frame& frame, const std::string& version) {
  json resolutions = json::array();
  for (int level = frame.num_levels - 1; level >= 0; --level) resolutions.push_back(frame.cell_size_m * (1 << level));
  const Eigen::Vector2d& corner = frame.north_west;
  return {{"id", layer.id},
          {"kind", layer.kind},
          {"frame", layer.frame},
          {"title", layer.title},
          {"version", version},
          {"tied", frame.tied},
          {"crs", frame.crs},
          {"origin", {corner.x(), corner.y()}},
          {"extent",
           {corner.x(), corner.y() - frame.height * frame.cell_size_m, corner.x() + frame.width * frame.cell_size_m,
            corner.y()}},
          {"resolutions", resolutions},
          {"tile", MapTiles::kTile}};
}

}  // namespace

std::string FrameOfBlock(const fs::path& site, const std::string& block) {
  const bool apart = fs::exists(site / "out" / "local" / (block + ".tif"));
  return apart ? block : "site";
}

TileLayers::TileLayers(fs::path site) : site_(std::move(site)) {}

std::vector<TileLayer> TileLayers::Layers() const {
  std::vector<TileLayer> layers;
  const auto add = [&](TileLayer layer) {
    if (fs::exists(layer.file)) layers.push_back(std::move(layer));
  };
  for (const std::string& block : pipeline::BlocksOf(site_)) {
    add({"raw-" + block, "raw", FrameOfBlock(site_, block), "before edits: " + block,
         site_ / "work" / block / "grid.tif"});
  }
  add({"map", "map", "site", "map", site_ / "out" / "site.tif"});
  for (const std::string& block : pipeline::BlocksOf(site_))
    add({"map-" + block, "map", block, "map of " + block, site_ / "out" / "local" / (block + ".tif")});
  add({"uncertainty", "uncertainty", "site", "uncertainty", site_ / "out" / "site.tif",
       MapTiles::Picture::kUncertainty});
  return layers;
}

TileLayers::Opened TileLayers::Open(const TileLayer& layer) {
  const std::string state = formats::Sha256(pipeline::FileState(layer.file)).substr(0, 16);
  const std::lock_guard lock(mutex_);
  Opened& opened = opened_[layer.id];
  if (opened.state != state) opened = {state, std::make_shared<MapTiles>(layer.file, layer.picture)};
  return opened;
}

json TileLayers::Description() {
  json layers = json::array();
  for (const TileLayer& layer : Layers()) {
    if (layer.picture == MapTiles::Picture::kUncertainty && !formats::HasUncertainty(layer.file)) continue;
    const Opened opened = Open(layer);
    layers.push_back(Describe(layer, opened.tiles->frame(), opened.state));
  }
  return layers;
}

std::string TileLayers::Tile(const std::string& id, int zoom, int column, int row, std::string* version) {
  for (const TileLayer& layer : Layers()) {
    if (layer.id != id) continue;
    const Opened opened = Open(layer);
    *version = opened.state;
    return opened.tiles->Tile(opened.tiles->frame().num_levels - 1 - zoom, column, row);
  }
  return "";
}

}  // namespace review
