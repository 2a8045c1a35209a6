// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace pipeline {

// Size and modification time of a file (of what a link points to) as text: equal text, most likely unchanged file.
// DataError when there is no such file.
std::string FileState(const std::filesystem::path& file);

}  // namespace pipeline
