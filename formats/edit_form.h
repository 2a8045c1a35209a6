// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace formats {

// How QGIS asks for the attributes of a drawn edit, as a part of a QML style: lists of kinds and classes, defaults,
// what must not be empty. For areas or for lines.
std::string EditFormQml(bool area);

}  // namespace formats
