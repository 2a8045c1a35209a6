// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_package.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/digest.h"
#include "formats/edit_form.h"
#include "formats/edit_json.h"
#include "formats/edit_layers.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/json_text.h"
#include "formats/vector_files.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using survey::EditKind;
using survey::MapEdit;

constexpr const char* kLines = "edit_lines";
constexpr const char* kAreas = "edit_areas";
constexpr const char* kCheckout = "plumbline_checkout";
constexpr const char* kBasisRow = "basis";

bool IsDrawable(const MapEdit& edit) {
  return edit.kind != EditKind::kCells && (edit.kind != EditKind::kAdjust || edit.parts.size() == 1);
}

// An edit without what people do not see.
MapEdit Visible(MapEdit edit) {
  edit.basis.clear();
  edit.anchors.clear();
  edit.beams.clear();
  return edit;
}

std::string TextOf(const std::optional<survey::StampNs>& stamp) { return stamp ? std::to_string(*stamp) : ""; }

VectorFeature FeatureOf(const MapEdit& edit) {
  VectorFeature feature{.vertices = edit.parts.front(), .values = {}, .holes = {}};
  feature.holes.assign(edit.parts.begin() + 1, edit.parts.end());
  feature.values = {edit.uid,
                    std::string(Name(edit.kind)),
                    std::string(Name(edit.obstacle)),
                    edit.width_m.value_or(std::numeric_limits<double>::quiet_NaN()),
                    std::string(Name(edit.frame)),
                    edit.sigma_m,
                    edit.who,
                    edit.why,
                    TextOf(edit.from_ns),
                    TextOf(edit.until_ns)};
  return feature;
}

VectorLayer LayerOf(const char* name, bool area, const std::vector<MapEdit>& edits) {
  VectorLayer layer{.name = name,
                    .shape = area ? VectorShape::kPolygon : VectorShape::kLine,
                    .colour = "#b0148a",
                    .label_field = "kind",
                    .category = "kind",
                    .categories = EditCategories(area)};
  layer.fields = {{"uid", true}, {"kind", true}, {"class", true}, {"width_m"},       {"frame", true},
                  {"sigma_m"},   {"who", true},  {"why", true},   {"from_ns", true}, {"until_ns", true}};
  layer.form = EditFormQml(area);
  for (const MapEdit& edit : edits) {
    if (IsDrawable(edit) && IsArea(edit.kind) == area) layer.features.push_back(FeatureOf(edit));
  }
  return layer;
}

// What was checked out, to compare with: a row per edit, and the maps they lie on.
VectorLayer Checkout(const std::vector<MapEdit>& edits, const std::map<std::string, std::string>& basis) {
  VectorLayer table{.name = kCheckout, .shape = VectorShape::kTable, .fields = {{"uid", true}, {"content", true}}};
  table.features.push_back({.vertices = {}, .values = {std::string(kBasisRow), JsonText(json(basis))}, .holes = {}});
  for (const MapEdit& edit : edits) {
    if (IsDrawable(edit))
      table.features.push_back({.vertices = {}, .values = {edit.uid, JsonText(ToJson(Visible(edit)))}, .holes = {}});
  }
  return table;
}

// One row as the members of an edit.
json MembersOf(OGRFeature* row) {
  json members;
  for (int i = 0; i < row->GetFieldCount(); ++i) {
    if (!row->IsFieldSetAndNotNull(i)) continue;
    const OGRFieldDefn* field = row->GetFieldDefnRef(i);
    if (field->GetType() == OFTReal || field->GetType() == OFTInteger) {
      members[field->GetNameRef()] = row->GetFieldAsDouble(i);
    } else {
      members[field->GetNameRef()] = row->GetFieldAsString(i);
    }
  }
  if (const OGRGeometry* geometry = row->GetGeometryRef()) {
    char* text = geometry->exportToJson();
    members["geometry"] = JsonOrDiscarded(text);
    CPLFree(text);
  }
  return members;
}

using Rows = std::vector<std::pair<std::string, json>>;  // what the row is called in messages; its members

Rows ReadRows(GDALDataset* data, const fs::path& file, const char* layer) {
  OGRLayer* table = data->GetLayerByName(layer);
  if (table == nullptr)
    throw DataError(file.string() + ": has no layer " + layer + "; it is not a checkout of `plumbline edits`");
  Rows rows;
  table->ResetReading();
  while (const OGRFeatureUniquePtr row{table->GetNextFeature()})
    rows.emplace_back(file.string() + ": " + layer + " " + std::to_string(row->GetFID()), MembersOf(row.get()));
  return rows;
}

struct CheckedOut {
  std::map<std::string, MapEdit> edits;
  std::map<std::string, std::string> basis;
};

CheckedOut ReadCheckout(GDALDataset* data, const fs::path& file) {
  CheckedOut checkout;
  for (const auto& [where, row] : ReadRows(data, file, kCheckout)) {
    try {
      const json content = ParsedJson(row.at("content").get<std::string>());
      if (row.at("uid") == kBasisRow) {
        checkout.basis = content.get<std::map<std::string, std::string>>();
      } else {
        const MapEdit edit = MovedEditFromJson(content, where);
        checkout.edits[edit.uid] = edit;
      }
    } catch (const json::exception& error) {
      throw DataError(where + ": is not as it was checked out: " + error.what());
    }
  }
  return checkout;
}

// What people can change: shape to 0.1 mm and attributes.
bool IsUnchanged(const MapEdit& now, const MapEdit& then) {
  json a = ToJson(now);
  json b = ToJson(then);
  for (const char* other : {"rev", "when", "tool", "supersedes"}) {
    a.erase(other);
    b.erase(other);
  }
  return a == b;
}

// The lines for one feature: none when it is as it was checked out.
void AddChange(MapEdit edit, const std::string& where, const CheckedOut& checkout, std::vector<LedgerLine>* lines) {
  if (edit.frame == survey::EditFrame::kMap) edit.basis = checkout.basis;
  const auto then = checkout.edits.find(edit.uid);
  if (then == checkout.edits.end()) {
    // So that the same feature is not taken twice.
    if (edit.uid.empty()) edit.uid = Sha256(JsonText(ToJson(Visible(edit)))).substr(0, 12);
    lines->push_back({LedgerOperation::kAdd, std::move(edit), where});
  } else if (!IsUnchanged(Visible(edit), then->second)) {
    edit.revision = then->second.revision + 1;
    edit.supersedes = then->second.supersedes;
    lines->push_back({LedgerOperation::kModify, std::move(edit), where});
  }
}

}  // namespace

void WriteEditPackage(const fs::path& file, const std::vector<MapEdit>& edits,
                      const std::map<std::string, std::string>& basis, const RasterLabel& label) {
  WriteGeoPackage(file, {LayerOf(kAreas, true, edits), LayerOf(kLines, false, edits), Checkout(edits, basis)}, label,
                  {.records = {{.stage = "edits", .version = "", .options = {}, .inputs = {}}}});
}

std::vector<LedgerLine> ReadEditPackage(const fs::path& file) {
  const GdalSession session;
  const char* const drivers[] = {"GPKG", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoPackage");
  const CheckedOut checkout = ReadCheckout(data.get(), file);
  std::vector<LedgerLine> lines;
  std::map<std::string, std::string> seen;  // uid; where
  for (const char* layer : {kAreas, kLines}) {
    for (const auto& [where, members] : ReadRows(data.get(), file, layer)) {
      const MapEdit edit = MovedEditFromJson(members, where);
      if (!edit.uid.empty() && !seen.try_emplace(edit.uid, where).second)
        throw DataError(where + ": uid = " + edit.uid + ": the same as of " + seen[edit.uid] +
                        " (a copied feature needs a uid of its own: clear the field)");
      AddChange(edit, where, checkout, &lines);
    }
  }
  for (const auto& [uid, edit] : checkout.edits) {
    if (seen.contains(uid)) continue;
    LedgerLine gone{.operation = LedgerOperation::kRetire};
    gone.edit.uid = uid;
    gone.edit.revision = edit.revision + 1;
    lines.push_back(std::move(gone));
  }
  return lines;
}

}  // namespace formats
