// SPDX-License-Identifier: Apache-2.0
//
// work/B1/masks.json: the beams of a block that people masked, out of the site's ledger. README.md, "Map edits".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/provenance.h"
#include "survey/edits/map_edit.h"

namespace formats {

void WriteMasks(const std::filesystem::path& file, const std::vector<survey::MaskedBeams>& beams,
                const Provenance& provenance);

// DataError names the file when it is not of this form and version.
std::vector<survey::MaskedBeams> ReadMasks(const std::filesystem::path& file);

// Equal for equal beams.
std::string CanonicalText(const std::vector<survey::MaskedBeams>& beams);

}  // namespace formats
