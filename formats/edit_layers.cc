// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_layers.h"

namespace formats {
namespace {

const std::vector<VectorField> kFields = {{"kind", true}, {"uid", true},  {"class", true}, {"aslam_type"},
                                          {"who", true},  {"when", true}, {"why", true},   {"finding", true},
                                          {"moved_mm"},   {"residual_mm"}};

std::vector<std::variant<double, std::string>> ValuesOf(const survey::SiteEdit& site_edit) {
  const survey::MapEdit& edit = site_edit.applied.edit;
  return {std::string(Name(edit.kind)),
          edit.uid,
          std::string(Name(edit.obstacle)),
          static_cast<double>(survey::AslamType(edit.obstacle)),
          edit.who,
          edit.when,
          edit.why,
          std::string(site_edit.has_finding ? "look at it" : ""),
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

}  // namespace

std::vector<VectorLayer> EditLayers(const std::vector<survey::SiteEdit>& edits) {
  VectorLayer areas{.name = "edit_areas", .shape = VectorShape::kPolygon, .colour = "#b0148a", .label_field = "kind"};
  VectorLayer lines{.name = "edit_lines", .shape = VectorShape::kLine, .colour = "#b0148a", .label_field = "kind"};
  areas.fields = lines.fields = kFields;
  for (const survey::SiteEdit& edit : edits) AddFeatures(edit, IsArea(edit.applied.edit.kind) ? &areas : &lines);
  return {areas, lines};
}

}  // namespace formats
