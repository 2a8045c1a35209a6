// SPDX-License-Identifier: Apache-2.0
//
// Logs of the Carnegie Mellon Robot Navigation Toolkit (CARMEN), one message a line: FLASER, RLASER, ROBOTLASER1/2,
// RAWLASER1/2, ODOM and the PARAMs of the laser mounting. README.md ("CARMEN logs") gives the rules: which messages are
// used, how beams are placed, what the largest readings mean, and which stamps are repaired.
#pragma once

#include <filesystem>

#include "formats/field_data.h"

namespace formats {

// Scans may be empty (a log without scans). DataError names file, row and field of a malformed message; only a last
// line that a crash cut off is a warning.
FieldData ReadCarmenLog(const std::filesystem::path& file, const FieldDataOptions& options);

}  // namespace formats
