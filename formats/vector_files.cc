// SPDX-License-Identifier: Apache-2.0
#include "formats/vector_files.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <memory>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_crs.h"
#include "formats/vector_style.h"

namespace formats {
namespace {

constexpr const char* kDate = "1970-01-01T00:00:00.000Z";
constexpr double kTextHeight_m = 0.5;

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Closer>;

// Sets a configuration option of GDAL for this thread while it lives.
class ConfigOption {
 public:
  ConfigOption(const char* key, const char* value) : key_(key) { CPLSetThreadLocalConfigOption(key, value); }
  ~ConfigOption() { CPLSetThreadLocalConfigOption(key_, nullptr); }
  ConfigOption(const ConfigOption&) = delete;
  ConfigOption& operator=(const ConfigOption&) = delete;

 private:
  const char* key_;
};

Dataset Create(const char* driver_name, const std::filesystem::path& file) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  if (driver == nullptr) throw DataError(file.string() + ": this GDAL has no driver " + driver_name);
  return Dataset(driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
}

void AddVertices(const std::vector<Eigen::Vector2d>& vertices, OGRSimpleCurve* curve) {
  for (const Eigen::Vector2d& vertex : vertices) curve->addPoint(vertex.x(), vertex.y());
}

void AddRing(const std::vector<Eigen::Vector2d>& vertices, OGRPolygon* polygon) {
  auto ring = std::make_unique<OGRLinearRing>();
  AddVertices(vertices, ring.get());
  ring->closeRings();
  polygon->addRingDirectly(ring.release());
}

std::unique_ptr<OGRGeometry> Geometry(const VectorFeature& feature, VectorShape shape) {
  if (shape == VectorShape::kPoint) {
    return std::make_unique<OGRPoint>(feature.vertices.front().x(), feature.vertices.front().y());
  }
  if (shape == VectorShape::kLine) {
    auto line = std::make_unique<OGRLineString>();
    AddVertices(feature.vertices, line.get());
    return line;
  }
  auto polygon = std::make_unique<OGRPolygon>();
  AddRing(feature.vertices, polygon.get());
  for (const auto& hole : feature.holes) AddRing(hole, polygon.get());
  return polygon;
}

OGRwkbGeometryType TypeOf(VectorShape shape) {
  switch (shape) {
    case VectorShape::kPoint:
      return wkbPoint;
    case VectorShape::kLine:
      return wkbLineString;
    case VectorShape::kPolygon:
      return wkbPolygon;
    case VectorShape::kTable:
      break;
  }
  return wkbNone;
}

using FeaturePointer = std::unique_ptr<OGRFeature>;

void SetValues(const VectorLayer& layer, const VectorFeature& feature, OGRFeature* row) {
  for (std::size_t i = 0; i < layer.fields.size(); ++i) {
    const int field = static_cast<int>(i);
    if (layer.fields[i].is_text) {
      row->SetField(field, std::get<std::string>(feature.values[i]).c_str());
    } else if (const double number = std::get<double>(feature.values[i]); !std::isnan(number)) {
      row->SetField(field, number);
    }
  }
}

void AddLayer(const VectorLayer& layer, OGRSpatialReference* crs, GDALDataset* dataset) {
  OGRLayer* table = dataset->CreateLayer(layer.name.c_str(), layer.shape == VectorShape::kTable ? nullptr : crs,
                                         TypeOf(layer.shape), nullptr);
  if (table == nullptr) return;  // the session tells
  for (const VectorField& field : layer.fields) {
    OGRFieldDefn definition(field.name.c_str(), field.is_text ? OFTString : OFTReal);
    table->CreateField(&definition);
  }
  for (const VectorFeature& feature : layer.features) {
    const FeaturePointer row(OGRFeature::CreateFeature(table->GetLayerDefn()));
    SetValues(layer, feature, row.get());
    if (layer.shape != VectorShape::kTable) row->SetGeometryDirectly(Geometry(feature, layer.shape).release());
    if (table->CreateFeature(row.get()) != OGRERR_NONE) return;
  }
}

// QGIS looks for a style in the table layer_styles.
void AddStyles(const std::vector<VectorLayer>& layers, GDALDataset* dataset) {
  OGRLayer* table = dataset->CreateLayer("layer_styles", nullptr, wkbNone, nullptr);
  if (table == nullptr) return;
  const std::pair<const char*, OGRFieldType> fields[] = {{"f_table_catalog", OFTString},
                                                         {"f_table_schema", OFTString},
                                                         {"f_table_name", OFTString},
                                                         {"f_geometry_column", OFTString},
                                                         {"styleName", OFTString},
                                                         {"styleQML", OFTString},
                                                         {"styleSLD", OFTString},
                                                         {"useAsDefault", OFTInteger},
                                                         {"description", OFTString},
                                                         {"owner", OFTString},
                                                         {"ui", OFTString},
                                                         {"update_time", OFTDateTime}};
  for (const auto& [name, type] : fields) {
    OGRFieldDefn definition(name, type);
    if (type == OFTInteger) definition.SetSubType(OFSTBoolean);
    table->CreateField(&definition);
  }
  for (const VectorLayer& layer : layers) {
    if (layer.shape == VectorShape::kTable) continue;
    const FeaturePointer row(OGRFeature::CreateFeature(table->GetLayerDefn()));
    for (const char* empty : {"f_table_catalog", "f_table_schema", "styleSLD", "owner"}) row->SetField(empty, "");
    row->SetField("f_table_name", layer.name.c_str());
    row->SetField("f_geometry_column", "geom");
    row->SetField("styleName", layer.name.c_str());
    row->SetField("styleQML", QmlStyle(layer).c_str());
    row->SetField("useAsDefault", 1);
    row->SetField("update_time", kDate);
    if (table->CreateFeature(row.get()) != OGRERR_NONE) return;
  }
}

void AddDxfEntity(const VectorLayer& layer, std::unique_ptr<OGRGeometry> geometry, const std::string& style,
                  OGRLayer* entities) {
  const FeaturePointer row(OGRFeature::CreateFeature(entities->GetLayerDefn()));
  row->SetField("Layer", layer.name.c_str());
  row->SetStyleString(style.c_str());
  row->SetGeometryDirectly(geometry.release());
  if (entities->CreateFeature(row.get()) != OGRERR_NONE) return;
}

void AddDxfLayer(const VectorLayer& layer, OGRLayer* entities) {
  for (const VectorFeature& feature : layer.features) {
    AddDxfEntity(layer, Geometry(feature, layer.shape), "PEN(c:" + layer.colour + ")", entities);
    if (layer.shape != VectorShape::kPoint || layer.label_field.empty()) continue;
    const std::string label = std::get<std::string>(feature.values.front());
    AddDxfEntity(
        layer, Geometry(feature, layer.shape),
        "LABEL(f:\"Arial\",t:\"" + label + "\",c:" + layer.colour + ",s:" + std::to_string(kTextHeight_m) + "g)",
        entities);
  }
}

}  // namespace

void WriteGeoPackage(const std::filesystem::path& file, const std::vector<VectorLayer>& layers,
                     const RasterLabel& label, const Provenance& provenance) {
  const GdalSession session;
  const ConfigOption date("OGR_CURRENT_DATE", kDate);
  AtomicFile output(file);
  Dataset dataset = Create("GPKG", output.temporary());
  session.ThrowIfFailed(file, "cannot be written");
  OGRSpatialReference crs;
  crs.importFromWkt(Wkt2OfLabel(label).c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  for (const VectorLayer& layer : layers) AddLayer(layer, &crs, dataset.get());
  AddStyles(layers, dataset.get());
  dataset->SetMetadataItem("PLUMBLINE_PROVENANCE", JsonTextOf(provenance).c_str());
  dataset.reset();
  session.ThrowIfFailed(file, "cannot be written");
  output.Commit();
}

void WriteDxf(const std::filesystem::path& file, const std::vector<VectorLayer>& layers) {
  const GdalSession session;
  AtomicFile output(file);
  Dataset dataset = Create("DXF", output.temporary());
  session.ThrowIfFailed(file, "cannot be written");
  OGRLayer* entities = dataset->CreateLayer("entities", nullptr, wkbUnknown, nullptr);
  if (entities != nullptr) {
    for (const VectorLayer& layer : layers) AddDxfLayer(layer, entities);
  }
  dataset.reset();
  session.ThrowIfFailed(file, "cannot be written");
  output.Commit();
}

}  // namespace formats
