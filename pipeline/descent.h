// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace pipeline {

// DataError unless `file` was made from `ancestor`, directly or over other stages, as the provenance in both tells.
void RequireDescent(const std::filesystem::path& file, const std::filesystem::path& ancestor);

}  // namespace pipeline
