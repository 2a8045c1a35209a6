// SPDX-License-Identifier: Apache-2.0
#include "formats/joint_file.h"

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/joint_json.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "plumbline-joint";
constexpr int kVersion = 1;

}  // namespace

void WriteJoint(const std::filesystem::path& file, const survey::JointSummary& summary, const Provenance& provenance) {
  json document = summary;
  document["format"] = kFormat;
  document["format_version"] = kVersion;
  document["provenance"] = ToJson(provenance);
  WriteJson(file, document);
}

survey::JointSummary ReadJoint(const std::filesystem::path& file) {
  const json document = JsonOrDiscarded(ReadWholeFile(file));
  try {
    if (!document.is_object() || document.at("format") != kFormat || document.at("format_version") != kVersion)
      throw DataError(file.string() + ": is not a joint.json of this version (or was cut off)");
    return document.get<survey::JointSummary>();
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

}  // namespace formats
