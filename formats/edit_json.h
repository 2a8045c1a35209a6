// SPDX-License-Identifier: Apache-2.0
//
// A map edit as JSON: the members of a line of the ledger and of a GeoJSON feature's properties. README.md, "Map
// edits".
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "survey/edits/map_edit.h"

namespace formats {

// `object` has the members of an edit and nothing else. Every complaint (DataError) starts with `where`: unknown
// member, kind, class or state, a geometry that the kind does not have, too few corners, an area that crosses itself, a
// number that is none. Whether there is a uid, a who and a when is the ledger's affair.
survey::MapEdit EditFromJson(const nlohmann::json& object, const std::string& where);

// The same of an edit that has moved with its scans: its rings may cross by then.
survey::MapEdit MovedEditFromJson(const nlohmann::json& object, const std::string& where);

// Coordinates rounded to 0.1 mm; what has its default is left out.
nlohmann::json ToJson(const survey::MapEdit& edit);

// GeoJSON geometry of the kind: LineString, Polygon, MultiPolygon (cells), MultiLineString (arrows).
nlohmann::json GeometryToJson(const survey::MapEdit& edit);

}  // namespace formats
