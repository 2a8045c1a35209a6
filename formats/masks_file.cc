// SPDX-License-Identifier: Apache-2.0
#include "formats/masks_file.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::MaskedBeams;

constexpr const char* kFormat = "plumbline-masks";
constexpr int kFormatVersion = 1;

json ToJson(const std::vector<MaskedBeams>& beams) {
  json array = json::array();
  for (const MaskedBeams& run : beams) array.push_back({run.stamp_ns, run.first, run.last});
  return array;
}

}  // namespace

void WriteMasks(const std::filesystem::path& file, const std::vector<MaskedBeams>& beams,
                const Provenance& provenance) {
  const json document = {{"format", kFormat},
                         {"format_version", kFormatVersion},
                         {"beams", ToJson(beams)},
                         {"provenance", ToJson(provenance)}};
  WriteFileAtomically(file, document.dump() + "\n");
}

std::vector<MaskedBeams> ReadMasks(const std::filesystem::path& file) {
  const json document = json::parse(ReadWholeFile(file), nullptr, false);
  const bool known = document.is_object() && document.value("format", json()) == kFormat &&
                     document.value("format_version", json()) == kFormatVersion;
  if (!known) throw DataError(file.string() + ": is not a masks.json of this version (or was cut off)");
  try {
    std::vector<MaskedBeams> beams;
    for (const json& run : document.at("beams"))
      beams.push_back({run.at(0).get<survey::StampNs>(), run.at(1).get<int>(), run.at(2).get<int>()});
    return beams;
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

std::string CanonicalText(const std::vector<MaskedBeams>& beams) { return ToJson(beams).dump(); }

}  // namespace formats
