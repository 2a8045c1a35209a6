// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_layers.h"

namespace formats {
namespace {

using survey::CellState;
using survey::EditKind;

constexpr const char* kOther = "#b0148a";  // what is told by its label alone
// In QGIS' language.
constexpr const char* kKindOrState = "if(\"state\" = 'active', \"kind\", \"state\")";

const std::vector<VectorField> kFields = {{"kind", true},   {"uid", true}, {"class", true}, {"aslam_type"},
                                          {"state", true},  {"who", true}, {"when", true},  {"why", true},
                                          {"remark", true}, {"moved_mm"},  {"residual_mm"}};

VectorCategory CategoryOf(EditKind kind) {
  const std::string name(Name(kind));
  if (kind == EditKind::kForbidden) return {name, "#c92a2a", "solid", "b_diagonal"};
  if (kind == EditKind::kMaskReturns) return {name, "#d9722f", "dash", "f_diagonal"};
  if (kind == EditKind::kAdjust) return {name, "#1f5fa8"};
  const std::optional<CellState> state = StateOf(kind);
  if (state == CellState::kOccupied) return {name, "#5c2d91", "solid", "cross"};
  if (state == CellState::kFree) return {name, "#2b8a3e", "solid", "no"};
  if (state == CellState::kUnknown) return {name, "#6a6f78", "dash", "no"};
  return {name, kOther, "solid", "no"};
}

std::vector<std::variant<double, std::string>> ValuesOf(const survey::SiteEdit& site_edit) {
  const survey::MapEdit& edit = site_edit.applied.edit;
  return {std::string(Name(edit.kind)),
          edit.uid,
          std::string(Name(edit.obstacle)),
          static_cast<double>(survey::AslamType(edit.obstacle)),
          std::string(Name(site_edit.state)),
          edit.who,
          edit.when,
          edit.why,
          site_edit.remark,
          1000.0 * site_edit.applied.shift_m,
          1000.0 * site_edit.applied.residual_m};
}

void AddFeatures(const survey::SiteEdit& site_edit, VectorLayer* layer) {
  const survey::MapEdit& edit = site_edit.applied.edit;
  const bool one = IsArea(edit.kind) && edit.kind != survey::EditKind::kCells;
  for (const auto& part : edit.parts) {
    layer->features.push_back({.vertices = part, .values = ValuesOf(site_edit), .holes = {}});
    if (!one) continue;
    layer->features.back().holes.assign(edit.parts.begin() + 1, edit.parts.end());
    return;
  }
}

VectorLayer EmptyLayer(const char* name, bool area) {
  VectorLayer layer{.name = name,
                    .shape = area ? VectorShape::kPolygon : VectorShape::kLine,
                    .colour = kOther,
                    .label_field = "kind",
                    .category = kKindOrState,
                    .categories = EditCategories(area),
                    .fields = kFields};
  layer.categories.push_back({std::string(Name(survey::EditState::kStale)), "#e03131", "dash", "cross"});
  layer.categories.push_back({std::string(Name(survey::EditState::kRetired)), "#9aa0a6", "dot", "no"});
  return layer;
}

}  // namespace

std::vector<VectorLayer> EditLayers(const std::vector<survey::SiteEdit>& edits) {
  VectorLayer areas = EmptyLayer("edit_areas", true);
  VectorLayer lines = EmptyLayer("edit_lines", false);
  for (const survey::SiteEdit& edit : edits) AddFeatures(edit, IsArea(edit.applied.edit.kind) ? &areas : &lines);
  return {areas, lines};
}

std::vector<VectorCategory> EditCategories(bool area) {
  std::vector<VectorCategory> categories;
  for (const EditKind kind : survey::kEditKinds) {
    if (IsArea(kind) == area) categories.push_back(CategoryOf(kind));
  }
  return categories;
}

}  // namespace formats
