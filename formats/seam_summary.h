// SPDX-License-Identifier: Apache-2.0
//
// The part of seams.json that the certificate repeats.
#pragma once

#include <filesystem>
#include <vector>

#include "survey/accuracy/certificate.h"

namespace formats {

// DataError names the file when it is not a seams.json of this version.
std::vector<survey::SeamSummary> ReadSeamSummaries(const std::filesystem::path& file);

}  // namespace formats
