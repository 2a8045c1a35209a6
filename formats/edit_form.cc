// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_form.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "formats/html.h"
#include "survey/edits/edit_kind.h"

namespace formats {
namespace {

using Choices = std::vector<std::pair<std::string, std::string>>;  // what is shown; the value

std::string Words(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string ValueMap(const std::string& field, const Choices& choices) {
  std::string qml = "<field name=\"" + field + "\"><editWidget type=\"ValueMap\"><config><Option type=\"Map\">" +
                    "<Option type=\"List\" name=\"map\">";
  for (const auto& [shown, value] : choices) {
    qml += "<Option type=\"Map\"><Option type=\"QString\" name=\"" + Escaped(shown) + "\" value=\"" + Escaped(value) +
           "\"/></Option>";
  }
  return qml + "</Option></Option></config></editWidget></field>";
}

std::string Hidden(const std::string& field) {
  return "<field name=\"" + field + "\"><editWidget type=\"Hidden\"><config/></editWidget></field>";
}

std::string Default(const std::string& field, const std::string& expression) {
  return "<default field=\"" + field + "\" expression=\"" + Escaped(expression) + "\" applyOnUpdate=\"0\"/>";
}

std::string NotNull(const std::string& field) {
  return "<constraint field=\"" + field +
         "\" constraints=\"1\" notnull_strength=\"1\" unique_strength=\"0\" exp_strength=\"0\"/>";
}

std::string Alias(const std::string& field, const std::string& shown) {
  return "<alias field=\"" + field + "\" name=\"" + Escaped(shown) + "\"/>";
}

Choices Kinds(bool area) {
  Choices choices;
  for (const survey::EditKind kind : survey::kEditKinds) {
    if (IsArea(kind) == area && kind != survey::EditKind::kCells)
      choices.emplace_back(Words(Name(kind)), std::string(Name(kind)));
  }
  return choices;
}

Choices Classes() {
  Choices choices;
  for (const survey::ObstacleClass obstacle : survey::kObstacleClasses) {
    const int type = survey::AslamType(obstacle);
    const std::string remark = type > 0 ? " (type " + std::to_string(type) + ")" : "";
    choices.emplace_back(Words(Name(obstacle)) + remark, std::string(Name(obstacle)));
  }
  return choices;
}

}  // namespace

std::string EditFormQml(bool area) {
  return "<fieldConfiguration>" + Hidden("uid") + ValueMap("kind", Kinds(area)) + ValueMap("class", Classes()) +
         (area ? Hidden("width_m") : Hidden("from_ns") + Hidden("until_ns")) +
         ValueMap("frame", {{"drawn on the map: moves with it", "map"}, {"measured on site: stays", "site"}}) +
         "</fieldConfiguration>\n<defaults>" + Default("uid", "uuid('WithoutBraces')") +
         Default("kind", area ? "'area_free'" : "'line_occupied'") + Default("frame", "'map'") +
         Default("sigma_m", "0.05") + Default("who", "@user_account_name") + "</defaults>\n<constraints>" +
         NotNull("kind") + NotNull("frame") + NotNull("who") + "</constraints>\n<aliases>" +
         Alias("from_ns", "masked from (UTC or stamp)") + Alias("until_ns", "masked until (UTC or stamp)") +
         "</aliases>\n";
}

}  // namespace formats
