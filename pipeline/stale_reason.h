// SPDX-License-Identifier: Apache-2.0
//
// Why make would run a stage again, for people: by the rules at the top of plumbline.mk, looking at one run alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/site_status.h"

namespace pipeline {

// "control/points.csv changed; option max-range-m: 30, was 25"; nothing when the run is up to date.
std::optional<std::string> WhyStale(const std::filesystem::path& site, const StageRunInfo& run);

// What differs between two configuration slices of a stage: the program's build and the values of options. Empty when
// nothing does.
std::string SliceChange(const std::string& before, const std::string& now);

}  // namespace pipeline
