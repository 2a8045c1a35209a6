// SPDX-License-Identifier: Apache-2.0
//
// A project that opens a site's map and its layers in QGIS as they are meant: free white, walls black, unknown clear,
// the layers over it in their styles. (By itself QGIS takes the two bands of site.tif for colours.) The files are named
// relative to the project: the folder may be moved.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/site_vectors.h"
#include "survey/control/control_point.h"
#include "survey/grid/site_raster.h"

namespace formats {

struct QgisProject {
  std::string title;
  survey::SiteFrame frame;
  std::filesystem::path map;         // site.tif; empty: none
  survey::SiteRaster map_frame;      // its size and place
  std::filesystem::path geopackage;  // site.gpkg, which holds the layers
  std::vector<VectorLayer> layers;   // from the lowest to the uppermost
};

void WriteQgisProject(const std::filesystem::path& file, const QgisProject& project);

}  // namespace formats
