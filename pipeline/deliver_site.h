// SPDX-License-Identifier: Apache-2.0
//
// `plumbline deliver`: notes in delivered/ what the results now rest on, so that later certificates tell what changed
// since. The notes are small text files that belong under version control with the site.
#pragma once

#include <filesystem>

namespace pipeline {

// DataError when the site is not up to date: only what was certified can be delivered.
void DeliverSite(const std::filesystem::path& site);

}  // namespace pipeline
