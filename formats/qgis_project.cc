// SPDX-License-Identifier: Apache-2.0
#include "formats/qgis_project.h"

#include "formats/atomic_file.h"
#include "formats/html.h"
#include "formats/vector_style.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMapName = "site_map";

// Free (0) white, walls (100) black; the file tells what is unknown.
constexpr const char* kMapRenderer =
    "<pipe><rasterrenderer type=\"singlebandgray\" grayBand=\"1\" gradient=\"WhiteToBlack\" alphaBand=\"-1\" "
    "opacity=\"1\">"
    "<contrastEnhancement><minValue>0</minValue><maxValue>100</maxValue>"
    "<algorithm>StretchToMinimumMaximum</algorithm></contrastEnhancement></rasterrenderer></pipe>";

std::string Element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + Escaped(text) + "</" + name + ">";
}

std::string ReferenceSystem(const survey::SiteFrame& frame) {
  return "<spatialrefsys>" + Element("wkt", frame.wkt2) + Element("authid", frame.crs) + "</spatialrefsys>";
}

std::string RelativeTo(const fs::path& project, const fs::path& file) {
  return "./" + file.lexically_relative(project.parent_path()).string();
}

const char* GeometryOf(VectorShape shape) {
  return shape == VectorShape::kPoint ? "Point" : shape == VectorShape::kLine ? "Line" : "Polygon";
}

// QGIS makes up ids of its own for those of less than eleven characters.
std::string IdOf(const std::string& name) { return "plumbline_" + name; }

std::string TreeEntry(const std::string& name) {
  return "<layer-tree-layer id=\"" + IdOf(name) + "\" name=\"" + Escaped(name) + "\" checked=\"Qt::Checked\"/>\n";
}

std::string LayerHead(const std::string& name, const std::string& source, const std::string& provider,
                      const survey::SiteFrame& frame) {
  return Element("id", IdOf(name)) + Element("datasource", source) + Element("layername", name) +
         Element("provider", provider) + "<srs>" + ReferenceSystem(frame) + "</srs>\n";
}

std::string VectorLayerXml(const VectorLayer& layer, const std::string& package, const survey::SiteFrame& frame) {
  return std::string("<maplayer type=\"vector\" geometry=\"") + GeometryOf(layer.shape) + "\" labelsEnabled=\"" +
         (layer.label_field.empty() ? "0" : "1") + "\">" +
         LayerHead(layer.name, package + "|layername=" + layer.name, "ogr", frame) + StyleElements(layer) +
         "</maplayer>\n";
}

std::string Extent(const survey::SiteRaster& map) {
  const auto side = [&](const char* name, std::int64_t cells) {
    return Element(name, Fixed(static_cast<double>(cells) * map.cell_size_m, 3));
  };
  return "<mapcanvas name=\"theMapCanvas\"><units>meters</units><extent>" + side("xmin", map.min_column) +
         side("ymin", map.min_row) + side("xmax", map.min_column + map.width) + side("ymax", map.min_row + map.height) +
         "</extent></mapcanvas>\n";
}

}  // namespace

void WriteQgisProject(const fs::path& file, const QgisProject& project) {
  const std::string package = RelativeTo(file, project.geopackage);
  std::string tree;
  std::string layers;
  for (auto layer = project.layers.rbegin(); layer != project.layers.rend(); ++layer) {
    if (layer->shape == VectorShape::kTable) continue;
    tree += TreeEntry(layer->name);
    layers += VectorLayerXml(*layer, package, project.frame);
  }
  if (!project.map.empty()) {
    tree += TreeEntry(kMapName);
    layers += "<maplayer type=\"raster\">" + LayerHead(kMapName, RelativeTo(file, project.map), "gdal", project.frame) +
              kMapRenderer + "</maplayer>\n";
  }
  WriteFileAtomically(
      file,
      "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22.0\">\n" +
          Element("title", project.title) + "\n<projectCrs>" + ReferenceSystem(project.frame) +
          "</projectCrs>\n<layer-tree-group>\n" + tree + "</layer-tree-group>\n" +
          (project.map.empty() ? "" : Extent(project.map_frame)) + "<projectlayers>\n" + layers +
          "</projectlayers>\n<properties><SpatialRefSys><ProjectionsEnabled "
          "type=\"int\">1</ProjectionsEnabled></SpatialRefSys><Paths><Absolute type=\"bool\">false</Absolute></Paths>"
          "</properties>\n</qgis>\n");
}

}  // namespace formats
