// SPDX-License-Identifier: Apache-2.0
#include "stages/review/static_page.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "stages/review/answer_store.h"
#include "stages/review/edit_store.h"
#include "stages/review/site_documents.h"
#include "stages/review/text.h"
#include "stages/review/tile_layers.h"
#include "stages/review/web_files.h"

namespace review {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void RequireOurs(const fs::path& folder) {
  const bool empty = !fs::exists(folder) || fs::is_empty(folder);
  if (!empty && !fs::exists(folder / "data.js"))
    throw formats::DataError(folder.string() + ": holds other files; name a folder that is new or empty");
}

int WriteTiles(TileLayers* layers, const json& description, const fs::path& folder) {
  int count = 0;
  std::string version;
  for (const json& layer : description) {
    const std::string id = layer["id"];
    for (int zoom = 0; zoom < static_cast<int>(layer["resolutions"].size()); ++zoom) {
      for (int column = 0; !layers->Tile(id, zoom, column, 0, &version).empty(); ++column) {
        const fs::path place = folder / "tiles" / id / std::to_string(zoom) / std::to_string(column);
        for (int row = 0;; ++row) {
          const std::string png = layers->Tile(id, zoom, column, row, &version);
          if (png.empty()) break;
          formats::WriteFileAtomically(place / (std::to_string(row) + ".png"), png);
          ++count;
        }
      }
    }
  }
  return count;
}

std::string DataScript(const fs::path& site, const json& description) {
  const json data = {
      {"site", description},          {"requests", RequestsDocument(site)}, {"control", ControlDocument(site)},
      {"seams", SeamsDocument(site)}, {"answers", AnswerStore(site).All()}, {"edits", EditStore(site).All()}};
  return "window.PLUMBLINE = " + ReplacedAll(formats::JsonText(data), "</", "<\\/") + ";\n";
}

}  // namespace

int WriteStaticPage(const fs::path& site, const fs::path& web, const fs::path& folder) {
  RequireOurs(folder);
  const WebFiles files(web);
  TileLayers layers(site);
  const json description = SiteDocument(site, &layers);
  formats::WriteFileAtomically(folder / "data.js", DataScript(site, description));
  for (const auto& [path, bytes] : files.all()) {
    if (path.starts_with("vendor/ol/") || path.ends_with(".css")) formats::WriteFileAtomically(folder / path, bytes);
  }
  const int tiles = WriteTiles(&layers, description["layers"], folder);
  const std::string page =
      ReplacedAll(files.Page("review/index.html", "", true), "<!--DATA-->", "<script src=\"data.js\"></script>");
  formats::WriteFileAtomically(folder / "index.html", page);
  return tiles;
}

}  // namespace review
