// SPDX-License-Identifier: Apache-2.0
//
// What of the site's edits reaches back into the processing of a block: work/B1/masks.json, the beams that people
// masked, and work/B1/arrows.json, what they say lies elsewhere. README.md, "Map edits".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/provenance.h"
#include "survey/edits/map_arrow.h"
#include "survey/edits/map_edit.h"

namespace formats {

void WriteMasks(const std::filesystem::path& file, const std::vector<survey::MaskedBeams>& beams,
                const Provenance& provenance);

void WriteArrows(const std::filesystem::path& file, const std::vector<survey::MapArrow>& arrows,
                 const Provenance& provenance);

// DataError names the file when it is not of this form and version.
std::vector<survey::MaskedBeams> ReadMasks(const std::filesystem::path& file);
std::vector<survey::MapArrow> ReadArrows(const std::filesystem::path& file);

// Equal for equal content.
std::string CanonicalText(const std::vector<survey::MaskedBeams>& beams);
std::string CanonicalText(const std::vector<survey::MapArrow>& arrows);

}  // namespace formats
