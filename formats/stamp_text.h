// SPDX-License-Identifier: Apache-2.0
//
// Stamps of scans as people write them: nanoseconds on the block's clock, "1048200000000", or, where that clock is UTC
// as that of most logs, a time: "2026-11-28T10:15:00Z", "2026-11-28T10:15:00.25Z".
#pragma once

#include <optional>
#include <string>

#include "survey/sensors/session.h"

namespace formats {

// Empty for any other text, and for days that there are not.
std::optional<survey::StampNs> StampFromText(const std::string& text);

}  // namespace formats
