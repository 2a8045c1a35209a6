// SPDX-License-Identifier: Apache-2.0
//
// What a site's certificate knows, as layers for GIS and CAD: control, checks, error vectors, ellipses, trajectories
// and the differences of neighbouring blocks. Site frame (east, north; m). Vectors and ellipses are drawn enlarged by a
// round factor that stands in their attributes; attributes in mm are true.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "formats/certificate_html.h"
#include "survey/accuracy/certificate.h"

namespace formats {

enum class VectorShape { kPoint, kLine, kPolygon, kTable };  // a table has no places

struct VectorField {
  std::string name;
  bool is_text = false;  // else a number
};

struct VectorFeature {
  std::vector<Eigen::Vector2d> vertices;                  // one for a point; polygons are closed by the writer
  std::vector<std::variant<double, std::string>> values;  // in the order of the fields; NaN is stored as NULL
  std::vector<std::vector<Eigen::Vector2d>> holes;        // of polygons
};

// How features of one kind are drawn in QGIS.
struct VectorCategory {
  std::string value;  // of the layer's `category`
  std::string colour;
  std::string pattern = "solid";  // of lines and outlines: solid, dash, dot
  std::string fill = "no";        // of polygons: no, solid, b_diagonal, f_diagonal, cross
};

struct VectorLayer {
  std::string name;
  VectorShape shape = VectorShape::kPoint;
  std::string colour;       // "#1f5fa8"
  std::string symbol;       // of points: a marker's name as QGIS knows it
  std::string label_field;  // empty: not labelled
  std::string category;     // a field or an expression of QGIS; empty: all features are drawn alike
  std::vector<VectorCategory> categories;
  std::vector<VectorField> fields;
  std::vector<VectorFeature> features;
  std::string form;  // of the attributes in QGIS, QML; empty: as QGIS likes
};

// Layers without features are there too, so that tools find what they expect.
std::vector<VectorLayer> SiteVectorLayers(const survey::Certificate& certificate,
                                          const std::vector<BlockTrajectory>& trajectories);

}  // namespace formats
