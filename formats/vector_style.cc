// SPDX-License-Identifier: Apache-2.0
#include "formats/vector_style.h"

#include "formats/html.h"

namespace formats {
namespace {

std::string Property(const std::string& key, const std::string& value) {
  return "<prop k=\"" + key + "\" v=\"" + Escaped(value) + "\"/>";
}

// `one`: how the features are drawn.
std::string SymbolLayer(const VectorLayer& layer, const VectorCategory& one) {
  switch (layer.shape) {
    case VectorShape::kPoint:
      return "<layer class=\"SimpleMarker\">" + Property("name", layer.symbol) + Property("color", one.colour) +
             Property("outline_color", "#ffffff") + Property("size", "2.6") + "</layer>";
    case VectorShape::kLine:
      return "<layer class=\"SimpleLine\">" + Property("line_color", one.colour) + Property("line_style", one.pattern) +
             Property("line_width", "0.4") + "</layer>";
    case VectorShape::kPolygon:
      return "<layer class=\"SimpleFill\">" + Property("style", one.fill) + Property("color", one.colour) +
             Property("outline_color", one.colour) + Property("outline_style", one.pattern) +
             Property("outline_width", "0.3") + "</layer>";
    case VectorShape::kTable:
      break;
  }
  return "";
}

std::string Symbol(const VectorLayer& layer, const VectorCategory& one, std::size_t number) {
  const char* type = layer.shape == VectorShape::kPoint  ? "marker"
                     : layer.shape == VectorShape::kLine ? "line"
                                                         : "fill";
  return "<symbol name=\"" + std::to_string(number) + "\" type=\"" + type + "\">" + SymbolLayer(layer, one) +
         "</symbol>";
}

std::string Renderer(const VectorLayer& layer) {
  if (layer.categories.empty()) {
    return "<renderer-v2 type=\"singleSymbol\"><symbols>" + Symbol(layer, {.colour = layer.colour}, 0) +
           "</symbols></renderer-v2>\n";
  }
  std::string categories;
  std::string symbols;
  for (std::size_t i = 0; i < layer.categories.size(); ++i) {
    const VectorCategory& one = layer.categories[i];
    categories += "<category symbol=\"" + std::to_string(i) + "\" value=\"" + Escaped(one.value) + "\" label=\"" +
                  Escaped(one.value) + "\" render=\"true\"/>";
    symbols += Symbol(layer, one, i);
  }
  return "<renderer-v2 type=\"categorizedSymbol\" attr=\"" + Escaped(layer.category) + "\"><categories>" + categories +
         "</categories><symbols>" + symbols + "</symbols></renderer-v2>\n";
}

}  // namespace

std::string StyleElements(const VectorLayer& layer) {
  std::string qml = Renderer(layer);
  if (!layer.label_field.empty()) {
    qml += "<labeling type=\"simple\"><settings><text-style fieldName=\"" + layer.label_field +
           "\" fontSize=\"8\" textColor=\"" + layer.colour + "\"/></settings></labeling>\n";
  }
  return qml + layer.form;
}

std::string QmlStyle(const VectorLayer& layer) {
  return std::string(
             "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22\" labelsEnabled=\"") +
         (layer.label_field.empty() ? "0" : "1") + "\">\n" + StyleElements(layer) + "</qgis>\n";
}

}  // namespace formats
