// SPDX-License-Identifier: Apache-2.0
#include "formats/nav_check_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/csv.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "survey/planning/robot_path.h"

namespace formats {
namespace {

using nlohmann::json;

double Rounded(double value) { return std::round(value * 1e3) / 1e3; }

json PlaceToJson(const Eigen::Vector2d& place) { return {Rounded(place.x()), Rounded(place.y())}; }

json ResultToJson(const NavResult& result) {
  json object = {{"reachable", !result.path.empty()}, {"clearance_m", Rounded(result.clearance_m)}};
  object["length_m"] = result.path.empty() ? json() : json(Rounded(survey::LengthOf(result.path)));
  return object;
}

json LineFeature(const NavCheck& check, const char* map, const NavResult& result) {
  json line = json::array();
  for (const Eigen::Vector2d& place : result.path) line.push_back(PlaceToJson(place));
  return {
      {"type", "Feature"},
      {"properties", {{"goal", check.goal.name}, {"map", map}, {"length_m", Rounded(survey::LengthOf(result.path))}}},
      {"geometry", {{"type", "LineString"}, {"coordinates", line}}}};
}

}  // namespace

std::vector<NavGoal> ReadNavGoals(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"name", "easting", "northing"});
  std::vector<NavGoal> goals;
  while (csv.NextRow()) goals.push_back({std::string(csv.Text(0)), {csv.Number(1), csv.Number(2)}});
  if (goals.size() < 2)
    throw DataError(file.string() + ": needs two rows at least: where the robot starts, then its goals");
  return goals;
}

void WriteNavChecks(const std::filesystem::path& file, const NavGoal& start, const std::vector<NavCheck>& checks,
                    const Provenance& provenance) {
  json document = {{"format", "plumbline-nav-check"},
                   {"format_version", 1},
                   {"start", {{"name", start.name}, {"place", PlaceToJson(start.place)}}},
                   {"goals", json::array()},
                   {"provenance", ToJson(provenance)}};
  for (const NavCheck& check : checks) {
    document["goals"].push_back({{"name", check.goal.name},
                                 {"place", PlaceToJson(check.goal.place)},
                                 {"before", ResultToJson(check.before)},
                                 {"after", ResultToJson(check.after)}});
  }
  WriteJson(file, document);
}

void WriteNavLayer(const std::filesystem::path& file, const std::vector<NavCheck>& checks, const std::string& crs) {
  json document = {{"type", "FeatureCollection"}, {"features", json::array()}};
  if (crs.starts_with("EPSG:"))
    document["crs"] = {{"type", "name"}, {"properties", {{"name", "urn:ogc:def:crs:EPSG::" + crs.substr(5)}}}};
  for (const NavCheck& check : checks) {
    for (const auto& [map, result] : {std::pair{"before", &check.before}, std::pair{"after", &check.after}}) {
      if (result->path.size() > 1) document["features"].push_back(LineFeature(check, map, *result));
    }
  }
  WriteFileAtomically(file, JsonText(document) + "\n");
}

}  // namespace formats
