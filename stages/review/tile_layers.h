// SPDX-License-Identifier: Apache-2.0
//
// The maps of a site that the page can show, as pictures cut on demand: the stitched map and its uncertainty, each
// block's map before the edits, and the maps of blocks that are not tied to control, each in a frame of its own.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/map_tiles.h"

namespace review {

struct TileLayer {
  std::string id;     // "map", "uncertainty", "raw-B1", "map-B2", ...
  std::string kind;   // "map", "uncertainty", "raw"
  std::string frame;  // "site", or the block whose local frame it is
  std::string title;
  std::filesystem::path file;
  formats::MapTiles::Picture picture = formats::MapTiles::Picture::kOccupancy;
};

class TileLayers {
 public:
  explicit TileLayers(std::filesystem::path site);

  // What is there now, each with its frame, extent and levels; in the order in which it is drawn.
  nlohmann::json Description();

  // The PNG; empty when there is no such layer or tile. Levels count from the coarsest, as web maps do. `version` gets
  // what Description() calls so: it changes with the file.
  std::string Tile(const std::string& id, int zoom, int column, int row, std::string* version);

 private:
  struct Opened {
    std::string state;  // of the file when it was opened
    std::shared_ptr<formats::MapTiles> tiles;
  };
  std::vector<TileLayer> Layers() const;
  Opened Open(const TileLayer& layer);

  std::filesystem::path site_;
  std::mutex mutex_;
  std::map<std::string, Opened> opened_;
};

// The frame in which a block's map lies: "site", or the block's own name when it is tied to nothing and not alone.
std::string FrameOfBlock(const std::filesystem::path& site, const std::string& block);

}  // namespace review
