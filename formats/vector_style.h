// SPDX-License-Identifier: Apache-2.0
//
// How QGIS draws a layer, as the text of a QML style.
#pragma once

#include <string>

#include "formats/site_vectors.h"

namespace formats {

std::string QmlStyle(const VectorLayer& layer);

// The elements of the style, as they also stand in a layer of a project.
std::string StyleElements(const VectorLayer& layer);

}  // namespace formats
