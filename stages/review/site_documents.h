// SPDX-License-Identifier: Apache-2.0
//
// What the page is told about a site, as JSON. A document whose artefact is not there is empty, not an error: a person
// may look at a site before everything is computed.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "stages/review/tile_layers.h"

namespace review {

// {"name", "layers", "basis"}: the maps, and by block what they were drawn from: edits that are drawn on them say so.
nlohmann::json SiteDocument(const std::filesystem::path& site, TileLayers* layers);

// {"blocks": [...], "requests": [...]}: work/requests.jsonl as it is; each block with the frame that its map lies in.
nlohmann::json RequestsDocument(const std::filesystem::path& site);

// Control and check points: [{"name", "role", "x", "y", "sigma"}], m, site frame.
nlohmann::json ControlDocument(const std::filesystem::path& site);

// out/seams.geojson as it is.
nlohmann::json SeamsDocument(const std::filesystem::path& site);

}  // namespace review
