// SPDX-License-Identifier: Apache-2.0
//
// The coordinate reference system that a raster carries.
#pragma once

#include <string>

#include "formats/raster_file.h"

namespace formats {

// WKT2: the site's CRS; the control's own plane (an engineering CRS) when the site has none; a local frame named "not
// tied to control" when the raster is not tied.
std::string Wkt2OfLabel(const RasterLabel& label);

// One line for people: "EPSG:25832" or the name of the engineering CRS.
std::string CrsNameOfLabel(const RasterLabel& label);

}  // namespace formats
