// SPDX-License-Identifier: Apache-2.0
#include "formats/edits_file.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/edit_json.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::MapEdit;

MapEdit ReadFeature(const json& feature, const std::string& where) {
  if (!feature.is_object() || feature.value("type", json()) != "Feature")
    throw DataError(where + ": expected a GeoJSON Feature");
  json edit = feature.value("properties", json());
  if (!edit.is_object()) throw DataError(where + ": properties: expected an object");
  edit["geometry"] = feature.value("geometry", json());
  if (feature.contains("id") && feature["id"].is_string() && !edit.contains("uid")) edit["uid"] = feature["id"];
  return EditFromJson(edit, where);
}

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
  const std::string name = named.is_string() ? named.get<std::string>() : JsonText(crs);
  if (EpsgOf(name) == site_crs) return;
  throw DataError(file.string() + ": crs = " + name + ": edits must be in the site's coordinate system" +
                  (site_crs.empty() ? "" : " " + site_crs));
}

}  // namespace

std::vector<MapEdit> ReadEdits(const std::filesystem::path& file, const std::string& site_crs) {
  json document;
  try {
    document = ParsedJson(ReadWholeFile(file));
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": is not JSON: " + error.what());
  }
  if (!document.is_object() || document.value("type", json()) != "FeatureCollection" ||
      !document.contains("features") || !document["features"].is_array())
    throw DataError(file.string() + ": expected a GeoJSON FeatureCollection");
  RequireSiteCrs(file, document, site_crs);
  std::vector<MapEdit> edits;
  for (const json& feature : document["features"]) {
    edits.push_back(ReadFeature(feature, file.string() + ": feature " + std::to_string(edits.size() + 1)));
  }
  return edits;
}

}  // namespace formats
