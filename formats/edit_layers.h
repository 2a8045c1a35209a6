// SPDX-License-Identifier: Apache-2.0
//
// The edits of a site as layers beside those of its certificate (site_vectors.h).
#pragma once

#include <vector>

#include "formats/site_vectors.h"
#include "survey/edits/site_edits.h"

namespace formats {

// edit_areas (a feature for each square of cells) and edit_lines (arrows too), where the edits lie now.
std::vector<VectorLayer> EditLayers(const std::vector<survey::SiteEdit>& edits);

}  // namespace formats
