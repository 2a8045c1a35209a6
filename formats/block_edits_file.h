// SPDX-License-Identifier: Apache-2.0
//
// work/B1/edits.json: what the edits of the site did to the map of a block. README.md, "Map edits".
#pragma once

#include <filesystem>

#include "formats/provenance.h"
#include "survey/edits/block_edits.h"

namespace formats {

void WriteBlockEdits(const std::filesystem::path& file, const survey::BlockEdits& edits, const Provenance& provenance);

// DataError names the file when it is not of this form and version.
survey::BlockEdits ReadBlockEdits(const std::filesystem::path& file);

// What the edits ask of one block, as text: equal for equal meaning there, whatever else the ledger holds.
std::string CanonicalText(const std::string& block, const std::vector<survey::MapEdit>& edits);

}  // namespace formats
