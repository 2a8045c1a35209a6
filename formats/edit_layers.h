// SPDX-License-Identifier: Apache-2.0
//
// The edits of a site as layers beside those of its certificate (site_vectors.h).
#pragma once

#include <vector>

#include "formats/site_vectors.h"
#include "survey/edits/site_edits.h"

namespace formats {

// edit_areas (a feature for each square of cells) and edit_lines (arrows too), where the edits lie now; each kind is
// drawn in its own way, what is stale or retired by its state.
std::vector<VectorLayer> EditLayers(const std::vector<survey::SiteEdit>& edits);

// How the kinds of areas or of lines are drawn, by their names.
std::vector<VectorCategory> EditCategories(bool area);

}  // namespace formats
