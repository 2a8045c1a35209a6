// SPDX-License-Identifier: Apache-2.0
#include "formats/feedback_files.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::MapArrow;
using survey::MaskedBeams;

constexpr int kFormatVersion = 1;

json BeamsToJson(const std::vector<MaskedBeams>& beams) {
  json array = json::array();
  for (const MaskedBeams& run : beams) array.push_back({run.stamp_ns, run.first, run.last});
  return array;
}

json PlaceToJson(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

Eigen::Vector2d PlaceFromJson(const json& place) { return {place.at(0).get<double>(), place.at(1).get<double>()}; }

json ArrowsToJson(const std::vector<MapArrow>& arrows) {
  json array = json::array();
  for (const MapArrow& arrow : arrows) {
    array.push_back({{"name", arrow.name},
                     {"stamp_ns", arrow.tail.stamp_ns},
                     {"tail_in_scan", PlaceToJson(arrow.tail.p_in_scan)},
                     {"head", PlaceToJson(arrow.head_in_site)},
                     {"sigma_m", arrow.sigma_m}});
  }
  return array;
}

// Both files: format, version, one list, provenance.
void WriteList(const std::filesystem::path& file, const char* name, json list, const Provenance& provenance) {
  const json document = {{"format", std::string("plumbline-") + name},
                         {"format_version", kFormatVersion},
                         {name, std::move(list)},
                         {"provenance", ToJson(provenance)}};
  WriteFileAtomically(file, JsonText(document) + "\n");
}

template <typename Item, typename FromJson>
std::vector<Item> ReadList(const std::filesystem::path& file, const char* name, const FromJson& from_json) {
  const json document = JsonOrDiscarded(ReadWholeFile(file));
  const bool known = document.is_object() && document.value("format", json()) == std::string("plumbline-") + name &&
                     document.value("format_version", json()) == kFormatVersion;
  if (!known) throw DataError(file.string() + ": does not list " + name + " in this version (or was cut off)");
  try {
    std::vector<Item> items;
    for (const json& item : document.at(name)) items.push_back(from_json(item));
    return items;
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

}  // namespace

void WriteMasks(const std::filesystem::path& file, const std::vector<MaskedBeams>& beams,
                const Provenance& provenance) {
  WriteList(file, "masks", BeamsToJson(beams), provenance);
}

void WriteArrows(const std::filesystem::path& file, const std::vector<MapArrow>& arrows, const Provenance& provenance) {
  WriteList(file, "arrows", ArrowsToJson(arrows), provenance);
}

std::vector<MaskedBeams> ReadMasks(const std::filesystem::path& file) {
  return ReadList<MaskedBeams>(file, "masks", [](const json& run) {
    return MaskedBeams{run.at(0).get<survey::StampNs>(), run.at(1).get<int>(), run.at(2).get<int>()};
  });
}

std::vector<MapArrow> ReadArrows(const std::filesystem::path& file) {
  return ReadList<MapArrow>(file, "arrows", [](const json& arrow) {
    return MapArrow{arrow.at("name").get<std::string>(),
                    {arrow.at("stamp_ns").get<survey::StampNs>(), PlaceFromJson(arrow.at("tail_in_scan"))},
                    PlaceFromJson(arrow.at("head")),
                    arrow.at("sigma_m").get<double>()};
  });
}

std::string CanonicalText(const std::vector<MaskedBeams>& beams) { return JsonText(BeamsToJson(beams)); }

std::string CanonicalText(const std::vector<MapArrow>& arrows) { return JsonText(ArrowsToJson(arrows)); }

}  // namespace formats
