// SPDX-License-Identifier: Apache-2.0
#include "formats/block_edits_file.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/edit_json.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::AppliedEdit;
using survey::BlockEdits;
using survey::EditFinding;
using survey::FindingKind;
using survey::MapEdit;

constexpr const char* kFormat = "plumbline-block-edits";
constexpr int kFormatVersion = 2;
constexpr std::array kFindingKinds = {FindingKind::kConflict, FindingKind::kStale, FindingKind::kEditReview};

double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

// The edit as one block knows it.
MapEdit Reduced(const MapEdit& edit, const std::string& block) {
  MapEdit reduced = edit;
  const auto others = [&](const auto& item) { return item.first != block; };
  std::erase_if(reduced.basis, others);
  std::erase_if(reduced.anchors, others);
  std::erase_if(reduced.beams, others);
  return reduced;
}

json AppliedToJson(const AppliedEdit& applied) {
  MapEdit edit = applied.edit;
  edit.basis.clear();
  edit.anchors.clear();
  edit.beams.clear();
  return {{"edit", ToJson(edit)},
          {"drawn", applied.drawn.empty() ? json() : GeometryToJson(AsDrawn(applied))},
          {"aslam_type", survey::AslamType(edit.obstacle)},
          {"changed_cells", applied.changed_cells},
          {"vertices", applied.vertices},
          {"anchored", applied.anchored},
          {"lost", applied.lost},
          {"shift_m", Rounded(applied.shift_m)},
          {"residual_m", Rounded(applied.residual_m)},
          {"area_change", Rounded(applied.area_change)}};
}

// The parts before the scans moved them: of an edit that differs from the applied one in its geometry.
std::vector<std::vector<Eigen::Vector2d>> DrawnFromJson(const json& object, const std::string& where) {
  if (object.at("drawn").is_null()) return {};
  json drawn = object.at("edit");
  drawn["geometry"] = object["drawn"];
  return MovedEditFromJson(drawn, where).parts;
}

AppliedEdit AppliedFromJson(const json& object, const std::string& where) {
  return {.edit = MovedEditFromJson(object.at("edit"), where),
          .drawn = DrawnFromJson(object, where),
          .changed_cells = object.at("changed_cells").get<std::int64_t>(),
          .vertices = object.at("vertices").get<int>(),
          .anchored = object.at("anchored").get<int>(),
          .lost = object.at("lost").get<int>(),
          .shift_m = object.at("shift_m").get<double>(),
          .residual_m = object.at("residual_m").get<double>(),
          .area_change = object.at("area_change").get<double>()};
}

json FindingToJson(const EditFinding& finding) {
  return {{"kind", Name(finding.kind)},
          {"uids", finding.uids},
          {"message", finding.message},
          {"size_m", Rounded(finding.size_m)}};
}

EditFinding FindingFromJson(const json& object, const std::string& where) {
  for (const FindingKind kind : kFindingKinds) {
    if (object.at("kind") != Name(kind)) continue;
    return {kind, object.at("uids").get<std::vector<std::string>>(), object.at("message").get<std::string>(),
            object.at("size_m").get<double>()};
  }
  throw DataError(where + ": findings: kind = " + JsonText(object.at("kind")) + ": is not known");
}

}  // namespace

void WriteBlockEdits(const std::filesystem::path& file, const BlockEdits& edits, const Provenance& provenance) {
  json document = {{"format", kFormat},
                   {"format_version", kFormatVersion},
                   {"block", edits.block},
                   {"edited_cells", edits.edited_cells},
                   {"edits", json::array()},
                   {"findings", json::array()},
                   {"provenance", ToJson(provenance)}};
  for (const AppliedEdit& applied : edits.edits) document["edits"].push_back(AppliedToJson(applied));
  for (const EditFinding& finding : edits.findings) document["findings"].push_back(FindingToJson(finding));
  WriteJson(file, document);
}

BlockEdits ReadBlockEdits(const std::filesystem::path& file) {
  const json document = JsonOrDiscarded(ReadWholeFile(file));
  const bool known = document.is_object() && document.value("format", json()) == kFormat &&
                     document.value("format_version", json()) == kFormatVersion;
  if (!known) throw DataError(file.string() + ": is not an edits.json of this version (or was cut off)");
  try {
    BlockEdits edits{.block = document.at("block").get<std::string>()};
    edits.edited_cells = document.at("edited_cells").get<std::int64_t>();
    for (const json& applied : document.at("edits")) edits.edits.push_back(AppliedFromJson(applied, file.string()));
    for (const json& finding : document.at("findings"))
      edits.findings.push_back(FindingFromJson(finding, file.string()));
    return edits;
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

std::string CanonicalText(const std::string& block, const std::vector<MapEdit>& edits) {
  std::string text;
  for (const MapEdit& edit : edits) text += JsonText(ToJson(Reduced(edit, block))) + "\n";
  return text;
}

}  // namespace formats
