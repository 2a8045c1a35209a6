// SPDX-License-Identifier: Apache-2.0
#include "formats/edits_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::CellState;
using survey::MapEdit;

// Reads one feature; every complaint starts with file and feature.
class FeatureReader {
 public:
  explicit FeatureReader(std::string where) : where_(std::move(where)) {}

  MapEdit Read(const json& feature) const {
    if (!feature.is_object() || TextOf(feature, "type") != "Feature") Fail("expected a GeoJSON Feature");
    MapEdit edit;
    ReadProperties(feature.value("properties", json::object()), &edit);
    ReadGeometry(feature.value("geometry", json()), &edit);
    if (edit.is_area && edit.width_m) Fail("width_m is for lines, not for polygons");
    if (const auto crossing = survey::FindSelfCrossing(edit)) {
      char text[96];
      std::snprintf(text, sizeof text, "the polygon crosses or touches itself at %.3f %.3f", crossing->x(),
                    crossing->y());
      Fail(text);
    }
    return edit;
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { throw DataError(where_ + ": " + rule); }

  static std::string TextOf(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : "";
  }

  void ReadProperties(const json& properties, MapEdit* edit) const {
    if (!properties.is_object()) Fail("properties: expected an object");
    bool has_state = false;
    for (const auto& [key, value] : properties.items()) {
      if (key == "state") {
        edit->state = ReadState(value);
        has_state = true;
      } else if (key == "width_m") {
        if (value.is_null()) continue;
        if (!value.is_number() || !(value.get<double>() > 0)) Fail("width_m = " + value.dump() + ": must be positive");
        edit->width_m = value.get<double>();
      } else if (key == "who" || key == "why") {
        if (!value.is_string() && !value.is_null()) Fail(key + " = " + value.dump() + ": expected a text");
        if (value.is_string()) (key == "who" ? edit->who : edit->why) = value.get<std::string>();
      } else {
        Fail("unknown property \"" + key + "\"; known are state, width_m, who, why");
      }
    }
    if (!has_state) Fail("property state is missing");
  }

  CellState ReadState(const json& value) const {
    for (const CellState state : {CellState::kOccupied, CellState::kFree, CellState::kUnknown}) {
      if (value.is_string() && value.get<std::string>() == Name(state)) return state;
    }
    Fail("state = " + value.dump() + ": must be occupied, free or unknown");
  }

  void ReadGeometry(const json& geometry, MapEdit* edit) const {
    const std::string type = geometry.is_object() ? TextOf(geometry, "type") : "";
    const json coordinates = geometry.is_object() ? geometry.value("coordinates", json()) : json();
    if (type == "LineString") {
      edit->parts.push_back(ReadPoints(coordinates));
      if (edit->parts.front().size() < 2) Fail("a line needs two points");
    } else if (type == "Polygon") {
      edit->is_area = true;
      if (!coordinates.is_array() || coordinates.empty()) Fail("a polygon without rings");
      for (const json& ring : coordinates) edit->parts.push_back(ReadRing(ring));
    } else {
      Fail("geometry " + (type.empty() ? geometry.dump().substr(0, 40) : type) + ": must be LineString or Polygon");
    }
  }

  std::vector<Eigen::Vector2d> ReadRing(const json& coordinates) const {
    std::vector<Eigen::Vector2d> ring = ReadPoints(coordinates);
    if (ring.size() < 4 || ring.front() != ring.back()) Fail("a ring needs three corners and must end where it begins");
    ring.pop_back();
    return ring;
  }

  std::vector<Eigen::Vector2d> ReadPoints(const json& coordinates) const {
    if (!coordinates.is_array()) Fail("coordinates: expected an array");
    std::vector<Eigen::Vector2d> points;
    for (const json& point : coordinates) {
      if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number())
        Fail("coordinate " + point.dump().substr(0, 60) + ": expected [easting, northing]");
      points.emplace_back(point[0].get<double>(), point[1].get<double>());
    }
    return points;
  }

  std::string where_;
};

// "EPSG:25832" of "urn:ogc:def:crs:EPSG::25832" and the like.
std::string EpsgOf(const std::string& name) {
  const std::size_t colon = name.find_last_of(':');
  return name.find("EPSG") == std::string::npos || colon == std::string::npos ? name : "EPSG:" + name.substr(colon + 1);
}

void RequireSiteCrs(const std::filesystem::path& file, const json& document, const std::string& site_crs) {
  if (!document.contains("crs") || document["crs"].is_null()) return;
  const json& crs = document["crs"];
  const json properties = crs.is_object() ? crs.value("properties", json()) : json();
  const json named = properties.is_object() ? properties.value("name", json()) : json();
  const std::string name = named.is_string() ? named.get<std::string>() : crs.dump();
  if (EpsgOf(name) == site_crs) return;
  throw DataError(file.string() + ": crs = " + name + ": edits must be in the site's coordinate system" +
                  (site_crs.empty() ? "" : " " + site_crs));
}

}  // namespace

std::vector<MapEdit> ReadEdits(const std::filesystem::path& file, const std::string& site_crs) {
  json document;
  try {
    document = json::parse(ReadWholeFile(file));
  } catch (const json::parse_error& error) {
    throw DataError(file.string() + ": is not JSON: " + error.what());
  }
  if (!document.is_object() || document.value("type", json()) != "FeatureCollection" ||
      !document.contains("features") || !document["features"].is_array())
    throw DataError(file.string() + ": expected a GeoJSON FeatureCollection");
  RequireSiteCrs(file, document, site_crs);
  std::vector<MapEdit> edits;
  for (const json& feature : document["features"]) {
    const FeatureReader reader(file.string() + ": feature " + std::to_string(edits.size() + 1));
    edits.push_back(reader.Read(feature));
  }
  return edits;
}

}  // namespace formats
