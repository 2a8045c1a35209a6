// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/errors.h"
#include "formats/json_text.h"
#include "formats/stamp_text.h"
#include "survey/edits/map_arrow.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::EditKind;
using survey::MapEdit;
using Points = std::vector<Eigen::Vector2d>;

constexpr std::array kMembers = {"uid",     "kind",  "class", "state",   "geometry", "width_m",    "frame",
                                 "sigma_m", "who",   "when",  "why",     "tool",     "supersedes", "basis",
                                 "anchors", "beams", "rev",   "from_ns", "until_ns"};

double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

template <typename Values>
std::string NamesOf(const Values& values) {
  std::string text;
  for (const auto& value : values) {
    if (!Name(value).empty()) text += (text.empty() ? "" : ", ") + std::string(Name(value));
  }
  return text;
}

// Reads one edit; every complaint starts with its place.
class EditReader {
 public:
  EditReader(const json& object, const std::string& where) : object_(object), where_(where) {}

  MapEdit Read() const {
    if (!object_.is_object()) Fail("expected an object");
    CheckMembers();
    MapEdit edit;
    edit.kind = OneOf("kind", survey::kEditKinds);
    ReadAttributes(&edit);
    ReadGeometry(Member("geometry"), &edit);
    ReadBlocks(&edit);
    CheckShape(edit);
    return edit;
  }

  void RequireSimple(const MapEdit& edit) const {
    if (edit.kind == EditKind::kCells) return;
    const auto crossing = survey::FindSelfCrossing(edit);
    if (!crossing) return;
    char text[96];
    std::snprintf(text, sizeof text, "the polygon crosses or touches itself at %.3f %.3f", crossing->x(),
                  crossing->y());
    Fail(text);
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { throw DataError(where_ + ": " + rule); }
  [[noreturn]] void FailAt(const std::string& key, const json& value, const std::string& rule) const {
    Fail(key + " = " + JsonText(value).substr(0, 80) + ": " + rule);
  }

  bool Has(const char* key) const { return object_.contains(key) && !object_[key].is_null(); }
  const json& Member(const char* key) const {
    if (!Has(key)) Fail(std::string(key) + " is missing");
    return object_[key];
  }

  void CheckMembers() const {
    for (const auto& [key, value] : object_.items()) {
      if (std::find(kMembers.begin(), kMembers.end(), key) != kMembers.end()) continue;
      std::string known;
      for (const char* member : kMembers) known += (known.empty() ? "" : ", ") + std::string(member);
      Fail("unknown member \"" + key + "\"; known are " + known);
    }
  }

  template <typename Values>
  typename Values::value_type OneOf(const char* key, const Values& values) const {
    const json& text = Member(key);
    for (const auto value : values) {
      if (text == Name(value)) return value;
    }
    FailAt(key, text, "must be one of " + NamesOf(values));
  }

  std::string Text(const char* key) const {
    if (!Has(key)) return "";
    if (!object_[key].is_string()) FailAt(key, object_[key], "expected a text");
    return object_[key].get<std::string>();
  }

  double Positive(const char* key) const {
    const json& value = object_[key];
    if (!value.is_number() || !(value.get<double>() > 0) || !std::isfinite(value.get<double>()))
      FailAt(key, value, "must be positive");
    return value.get<double>();
  }

  std::optional<survey::StampNs> Stamp(const char* key) const {
    if (Has(key) && object_[key].is_number_integer()) return object_[key].get<survey::StampNs>();
    const std::string text = Text(key);
    if (text.empty()) return std::nullopt;
    const std::optional<survey::StampNs> stamp = StampFromText(text);
    if (!stamp) FailAt(key, text, "must be a scan's stamp in ns or a time in UTC as 2026-11-28T10:15:00Z");
    return stamp;
  }

  void ReadAttributes(MapEdit* edit) const {
    edit->uid = Text("uid");
    if (Has("rev")) {
      if (!object_["rev"].is_number_integer() || object_["rev"] < 1) FailAt("rev", object_["rev"], "must be 1 or more");
      edit->revision = object_["rev"].get<int>();
    }
    edit->who = Text("who");
    edit->when = Text("when");
    edit->why = Text("why");
    edit->tool = Text("tool");
    if (!Text("class").empty()) edit->obstacle = OneOf("class", survey::kObstacleClasses);
    if (Has("frame")) edit->frame = OneOf("frame", survey::kEditFrames);
    if (Has("sigma_m")) edit->sigma_m = Positive("sigma_m");
    if (Has("width_m")) edit->width_m = Positive("width_m");
    edit->from_ns = Stamp("from_ns");
    edit->until_ns = Stamp("until_ns");
    if (Has("state") || edit->kind == EditKind::kCells) edit->cells_state = OneOf("state", survey::kCellStates);
    if (!Has("supersedes")) return;
    for (const json& uid : Array("supersedes", object_["supersedes"])) {
      if (!uid.is_string()) FailAt("supersedes", uid, "expected the uid of an edit");
      edit->supersedes.push_back(uid.get<std::string>());
    }
  }

  const json& Array(const std::string& key, const json& value) const {
    if (!value.is_array()) FailAt(key, value, "expected an array");
    return value;
  }

  const json& Object(const char* key) const {
    if (!object_[key].is_object()) FailAt(key, object_[key], "expected an object with a member for each block");
    return object_[key];
  }

  // The rings or lines of a geometry of the kind.
  void ReadGeometry(const json& geometry, MapEdit* edit) const {
    const json type = geometry.is_object() ? geometry.value("type", json()) : json();
    const json coordinates = geometry.is_object() ? geometry.value("coordinates", json()) : json();
    const bool single = edit->kind != EditKind::kCells && edit->kind != EditKind::kAdjust;
    const bool area = IsArea(edit->kind);
    if (type == (area ? "Polygon" : "LineString")) {
      if (area) return ReadRings(coordinates, edit);
      edit->parts.push_back(ReadPoints(coordinates));
    } else if (!single && type == (area ? "MultiPolygon" : "MultiLineString")) {
      for (const json& part : Array("coordinates", coordinates)) {
        if (area) {
          ReadRings(part, edit);
        } else {
          edit->parts.push_back(ReadPoints(part));
        }
      }
    } else {
      const std::string wanted = area ? "Polygon" : "LineString";
      Fail("geometry " + (type.is_string() ? type.get<std::string>() : JsonText(geometry).substr(0, 40)) + ": " +
           std::string(Name(edit->kind)) + " needs a " + wanted + (single ? "" : " or Multi" + wanted));
    }
    if (edit->parts.empty()) Fail("geometry: has no coordinates");
  }

  void ReadRings(const json& coordinates, MapEdit* edit) const {
    if (edit->kind == EditKind::kCells && coordinates.size() > 1) Fail("cells have no holes");
    for (const json& ring : Array("coordinates", coordinates)) {
      Points points = ReadPoints(ring);
      if (points.size() < 4 || points.front() != points.back())
        Fail("a ring needs three corners and must end where it begins");
      points.pop_back();
      edit->parts.push_back(std::move(points));
    }
  }

  Eigen::Vector2d ReadPoint(const json& point) const {
    const bool pair = point.is_array() && point.size() >= 2 && point[0].is_number() && point[1].is_number();
    if (!pair) Fail("coordinate " + JsonText(point).substr(0, 60) + ": expected [easting, northing]");
    return {point[0].get<double>(), point[1].get<double>()};
  }

  Points ReadPoints(const json& coordinates) const {
    Points points;
    for (const json& point : Array("coordinates", coordinates)) points.push_back(ReadPoint(point));
    return points;
  }

  void CheckShape(const MapEdit& edit) const {
    if (edit.width_m && edit.kind != EditKind::kLineFree && edit.kind != EditKind::kLineOccupied)
      Fail("width_m is for lines, not for " + std::string(Name(edit.kind)));
    if (edit.cells_state && edit.kind != EditKind::kCells) Fail("state is for cells; other kinds name it");
    if ((edit.from_ns || edit.until_ns) && edit.kind != EditKind::kMaskReturns)
      Fail("from_ns and until_ns are for mask_returns, not for " + std::string(Name(edit.kind)));
    if (edit.from_ns && edit.until_ns && *edit.until_ns < *edit.from_ns)
      FailAt("until_ns", object_["until_ns"], "must not come before from_ns");
    for (const Points& part : edit.parts) {
      if (part.size() < 2) Fail("a line needs two points");
      if (edit.kind == EditKind::kAdjust && part.size() != 2) Fail("an arrow of adjust has two points: from, to");
    }
    if (edit.kind == EditKind::kAdjust && edit.sigma_m < survey::kLeastArrowSigma_m)
      FailAt("sigma_m", edit.sigma_m, "must be 0.05 or more for adjust: a person does not outweigh control");
    for (const auto& [block, anchors] : edit.anchors) {
      if (anchors.size() != NumVertices(edit)) Fail("anchors of block " + block + ": must be one for each vertex");
    }
  }

  void ReadBlocks(MapEdit* edit) const {
    if (Has("basis")) {
      for (const auto& [block, id] : Object("basis").items()) {
        if (!id.is_string()) FailAt("basis", id, "expected the id of a record");
        edit->basis[block] = id.get<std::string>();
      }
    }
    if (Has("anchors")) {
      for (const auto& [block, anchors] : Object("anchors").items()) {
        for (const json& anchor : Array("anchors", anchors)) edit->anchors[block].push_back(ReadAnchor(anchor));
      }
    }
    if (Has("beams")) {
      for (const auto& [block, spans] : Object("beams").items()) {
        for (const json& span : Array("beams", spans)) edit->beams[block].push_back(ReadBeams(span));
      }
    }
  }

  std::optional<survey::EditAnchor> ReadAnchor(const json& anchor) const {
    if (anchor.is_null()) return std::nullopt;
    if (!anchor.is_array() || anchor.size() != 3 || !anchor[0].is_number_integer())
      FailAt("anchors", anchor, "expected [stamp_ns, x, y] or null");
    return survey::EditAnchor{anchor[0].get<survey::StampNs>(), ReadPoint({anchor[1], anchor[2]})};
  }

  survey::MaskedBeams ReadBeams(const json& span) const {
    const bool three = span.is_array() && span.size() == 3 &&
                       std::all_of(span.begin(), span.end(), [](const json& n) { return n.is_number_integer(); });
    if (!three || span[1] < 0 || span[2] < span[1]) FailAt("beams", span, "expected [stamp_ns, first beam, last beam]");
    return {span[0].get<survey::StampNs>(), span[1].get<int>(), span[2].get<int>()};
  }

  const json& object_;
  const std::string& where_;
};

json PlaceToJson(const Eigen::Vector2d& p) { return {Rounded(p.x()), Rounded(p.y())}; }

json RingToJson(const Points& points, bool closed) {
  json array = json::array();
  for (const Eigen::Vector2d& p : points) array.push_back(PlaceToJson(p));
  if (closed) array.push_back(array.front());
  return array;
}

template <typename Items, typename Convert>
json ArrayOf(const Items& items, const Convert& convert) {
  json array = json::array();
  for (const auto& item : items) array.push_back(convert(item));
  return array;
}

void AddBlocks(const MapEdit& edit, json* object) {
  if (!edit.basis.empty()) (*object)["basis"] = edit.basis;
  for (const auto& [block, anchors] : edit.anchors) {
    (*object)["anchors"][block] = ArrayOf(anchors, [](const auto& anchor) -> json {
      if (!anchor) return nullptr;
      return {anchor->stamp_ns, Rounded(anchor->p_in_scan.x()), Rounded(anchor->p_in_scan.y())};
    });
  }
  for (const auto& [block, spans] : edit.beams) {
    (*object)["beams"][block] = ArrayOf(spans, [](const auto& span) -> json {
      return {span.stamp_ns, span.first, span.last};
    });
  }
}

}  // namespace

MapEdit EditFromJson(const json& object, const std::string& where) {
  const EditReader reader(object, where);
  MapEdit edit = reader.Read();
  reader.RequireSimple(edit);
  return edit;
}

MapEdit MovedEditFromJson(const json& object, const std::string& where) { return EditReader(object, where).Read(); }

json GeometryToJson(const MapEdit& edit) {
  const bool area = IsArea(edit.kind);
  const auto part = [&](const Points& points) { return RingToJson(points, area); };
  switch (edit.kind) {
    case EditKind::kCells:
      return {{"type", "MultiPolygon"},
              {"coordinates", ArrayOf(edit.parts, [&](const Points& ring) { return json::array({part(ring)}); })}};
    case EditKind::kAdjust:
      return {{"type", "MultiLineString"}, {"coordinates", ArrayOf(edit.parts, part)}};
    default:
      return {{"type", area ? "Polygon" : "LineString"},
              {"coordinates", area ? ArrayOf(edit.parts, part) : part(edit.parts.front())}};
  }
}

json ToJson(const MapEdit& edit) {
  json object = {{"uid", edit.uid},           {"rev", edit.revision},
                 {"kind", Name(edit.kind)},   {"geometry", GeometryToJson(edit)},
                 {"frame", Name(edit.frame)}, {"sigma_m", edit.sigma_m},
                 {"who", edit.who},           {"when", edit.when}};
  if (edit.obstacle != survey::ObstacleClass::kNone) object["class"] = Name(edit.obstacle);
  if (edit.cells_state) object["state"] = Name(*edit.cells_state);
  if (edit.width_m) object["width_m"] = *edit.width_m;
  if (edit.from_ns) object["from_ns"] = std::to_string(*edit.from_ns);
  if (edit.until_ns) object["until_ns"] = std::to_string(*edit.until_ns);
  if (!edit.why.empty()) object["why"] = edit.why;
  if (!edit.tool.empty()) object["tool"] = edit.tool;
  if (!edit.supersedes.empty()) object["supersedes"] = edit.supersedes;
  AddBlocks(edit, &object);
  return object;
}

}  // namespace formats
