// SPDX-License-Identifier: Apache-2.0
#include "formats/vector_style.h"

#include "formats/html.h"

namespace formats {
namespace {

std::string Property(const std::string& key, const std::string& value) {
  return "<prop k=\"" + key + "\" v=\"" + Escaped(value) + "\"/>";
}

std::string SymbolLayer(const VectorLayer& layer) {
  switch (layer.shape) {
    case VectorShape::kPoint:
      return "<layer class=\"SimpleMarker\">" + Property("name", layer.symbol) + Property("color", layer.colour) +
             Property("outline_color", "#ffffff") + Property("size", "2.6") + "</layer>";
    case VectorShape::kLine:
      return "<layer class=\"SimpleLine\">" + Property("line_color", layer.colour) + Property("line_width", "0.4") +
             "</layer>";
    case VectorShape::kPolygon:
      return "<layer class=\"SimpleFill\">" + Property("style", "no") + Property("outline_color", layer.colour) +
             Property("outline_width", "0.3") + "</layer>";
    case VectorShape::kTable:
      break;
  }
  return "";
}

const char* SymbolType(VectorShape shape) {
  return shape == VectorShape::kPoint ? "marker" : shape == VectorShape::kLine ? "line" : "fill";
}

}  // namespace

std::string StyleElements(const VectorLayer& layer) {
  std::string qml = std::string("<renderer-v2 type=\"singleSymbol\"><symbols><symbol name=\"0\" type=\"") +
                    SymbolType(layer.shape) + "\">" + SymbolLayer(layer) + "</symbol></symbols></renderer-v2>\n";
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
